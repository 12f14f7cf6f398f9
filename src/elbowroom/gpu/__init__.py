"""The same arithmetic on a GPU: carve and sweep by numba-cuda, bits as the processor has them; not yet measured."""

from elbowroom.gpu.carve import carve_on_gpu
from elbowroom.gpu.sweep import find_block_on_gpu

__all__ = ["carve_on_gpu", "find_block_on_gpu"]
