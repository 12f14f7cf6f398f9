"""An arm that stands on a table: which motions stop that are truly clear, with declared contact or without."""
