"""Cameras that are not exposed together, and things that move meanwhile."""
