"""Bit planes of evidence, word by word: how many cameras see through, and what else is said of a voxel."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted

ONE, TWO, THREE, DISPUTED, SURFACE, BLIND = range(6)
PLANES = 6
NOTHING = np.uint64(0)


class Answers(NamedTuple):
    """What is asked, and where the answers go; of all words at once, each kernel writes those of its own cubes.

    asked (words,) uint64: the voxels that are asked. fine (words,) bool: blocks that get the pixel test where windows
    do not settle them. complete: whether all cameras are asked of every voxel, and counted. planes (PLANES, words)
    uint64, zeros on entry. through_count, dispute_count: (words, 64) uint8 where complete, else of no size.
    """

    asked: np.ndarray
    fine: np.ndarray
    complete: bool
    planes: np.ndarray
    through_count: np.ndarray
    dispute_count: np.ndarray


@uncounted(cache=True)
def tally(counts, word, mask):
    """Counts one camera for each voxel of a mask: (words, 64) uint8."""
    for lane in range(64):
        counts[word, lane] += np.uint8((mask >> np.uint64(lane)) & np.uint64(1))


@njit(nogil=True, inline="always")
def note_through(answers, word, mask):
    """Adds one camera's word to the planes *at least 1, 2, 3 cameras see through*."""
    planes = answers.planes
    planes[THREE, word] |= planes[TWO, word] & mask
    planes[TWO, word] |= planes[ONE, word] & mask
    planes[ONE, word] |= mask
    if answers.complete:
        tally(answers.through_count, word, mask)


@njit(nogil=True, inline="always")
def note_disputed(answers, word, disputed, surface, blind):
    """Adds what one camera disputes, and why."""
    planes = answers.planes
    planes[DISPUTED, word] |= disputed
    planes[SURFACE, word] |= surface
    planes[BLIND, word] |= blind
    if answers.complete:
        tally(answers.dispute_count, word, disputed)


@njit(nogil=True, inline="always")
def make_canonical(planes, word):
    """Where three see through, nothing else is said; where there is a surface, blindness is not."""
    open_voxels = ~planes[THREE, word]
    planes[DISPUTED, word] &= open_voxels
    planes[SURFACE, word] &= open_voxels
    planes[BLIND, word] &= open_voxels & ~planes[SURFACE, word]
