"""Robots that others published: which load, which are refused with a place, whether any loses a part unsaid."""
