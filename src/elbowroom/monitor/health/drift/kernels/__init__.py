"""The drift watch in compiled loops."""
