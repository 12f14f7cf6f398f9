"""Texels, pyramid, footprint test, pixel test and counting in compiled loops."""
