"""Cameras, and where the machine's base is, from images of the machine itself in several poses."""
