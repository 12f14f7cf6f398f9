"""Kernels of the GPU; what they call are the processor's own."""
