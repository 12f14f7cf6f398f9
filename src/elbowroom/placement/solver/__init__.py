"""Finds placements by a model of its own; `placement.verification` judges the result independently."""
