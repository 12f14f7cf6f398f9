"""The swept check in compiled loops."""
