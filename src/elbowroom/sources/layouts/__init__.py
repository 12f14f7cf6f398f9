"""Depth images on disk as people lay them out: one layout a file, each says what belongs to which moment."""
