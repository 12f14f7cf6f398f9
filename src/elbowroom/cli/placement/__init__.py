"""`elbowroom placement` and its commands."""
