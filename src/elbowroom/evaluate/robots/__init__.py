"""Robots that others published: which of them load, which are refused with a place, and whether any loses a part unsaid."""
