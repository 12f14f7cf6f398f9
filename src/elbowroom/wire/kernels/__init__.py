"""Kernels of this stage: arrays in, arrays out."""
