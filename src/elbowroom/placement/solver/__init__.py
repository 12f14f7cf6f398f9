"""Finds placements. Its model of what cameras see is its own: `placement.verify` judges the result independently."""
