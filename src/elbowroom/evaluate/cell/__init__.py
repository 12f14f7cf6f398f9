"""A robot arm in its cell: which motions that are truly clear the cameras stop, and for what cause."""
