"""`elbowroom evaluate` and `elbowroom bench`."""
