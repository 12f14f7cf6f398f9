"""What calibration found: cameras, what changed, the margins that follow."""
