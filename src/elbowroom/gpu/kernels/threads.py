"""What one thread of the GPU does; `numba.cuda.jit` makes kernels of these."""

from numba import cuda, float64

from elbowroom.gpu.kernels.carve import carve_word
from elbowroom.gpu.kernels.sweep import meets_block
from elbowroom.reconstruct.kernels.box import LANES
from elbowroom.reconstruct.kernels.cone import VOXEL


def carve_words(carving):
    """Carves one word of a carve (`kernels.carve.Carving`)."""
    number = cuda.grid(1)
    if number < carving.words.size:
        voxel, lanes = cuda.local.array(1, VOXEL), cuda.local.array(1, LANES)
        carve_word(carving, number, voxel, lanes)


def sweep_samples(sweep):
    """Looks at one sample in one interval of a sweep (`kernels.sweep.Sweep`)."""
    thread = cuda.grid(1)
    interval, number = thread // sweep.samples.size, thread % sweep.samples.size
    if interval < sweep.placed.shape[0] and interval < sweep.first[0]:
        place = cuda.local.array(3, float64)
        triangle = cuda.local.array((3, 3), float64)
        if meets_block(sweep, interval, number, place, triangle):
            cuda.atomic.min(sweep.first, 0, interval)
