"""How fast the figures of a plan follow the hand."""
