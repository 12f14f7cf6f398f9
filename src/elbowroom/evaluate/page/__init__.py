"""What the page costs the monitor, how fast it is, and who gets in."""
