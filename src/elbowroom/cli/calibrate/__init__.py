"""`elbowroom calibrate` and its commands."""
