"""The thesis' experiments, each a part of one page."""
