"""Sensors and exact truth in compiled loops."""
