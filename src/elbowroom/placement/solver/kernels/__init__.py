"""The search in compiled loops."""
