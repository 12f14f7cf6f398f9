"""Pictures of a room without a screen, for papers and reports: rays instead of a graphics card."""
