"""Whether the latch is kept through kills, cut files and older files."""
