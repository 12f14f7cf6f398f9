"""Bits of voxels, for all kernels."""
