"""What stands still in front of the cameras, and the site file that names it: what the drift watch compares with."""
