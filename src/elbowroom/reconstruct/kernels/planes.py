"""Bit planes of evidence, word by word: how many cameras see through, and what else is said of a voxel."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted

ONE, TWO, THREE, DISPUTED, SURFACE, BLIND = range(6)
PLANES = 6
NOTHING = np.uint64(0)


@njit(nogil=True, inline="always")
def count_through(planes, word, mask):
    """Adds one camera's word to the planes *at least 1, 2, 3 cameras see through*."""
    planes[THREE, word] |= planes[TWO, word] & mask
    planes[TWO, word] |= planes[ONE, word] & mask
    planes[ONE, word] |= mask


@uncounted(cache=True)
def tally(counts, word, mask):
    """Counts one camera for each voxel of a mask: (words, 64) uint8."""
    for lane in range(64):
        counts[word, lane] += np.uint8((mask >> np.uint64(lane)) & np.uint64(1))


@njit(nogil=True, inline="always")
def make_canonical(planes, word):
    """Where three see through, nothing else is said; where there is a surface, blindness is not."""
    open_voxels = ~planes[THREE, word]
    planes[DISPUTED, word] &= open_voxels
    planes[SURFACE, word] &= open_voxels
    planes[BLIND, word] &= open_voxels & ~planes[SURFACE, word]
