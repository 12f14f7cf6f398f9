"""Where a voxel's bit lies: 64 voxels of a 4 x 4 x 4 block share one uint64, 64 such words make a 16-voxel cube."""

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numba.cpython.unsafe.numbers import trailing_zeros
from numba.extending import overload


def uncounted(**options: Any) -> Any:
    """As `njit(nogil=True, **options)`, for small kernels of inner loops that allocate nothing.

    They count no references to the arrays that they are handed, which all threads would do on the same few words of
    memory (https://github.com/numba/numba/issues/2345). Whoever calls them holds the arrays.
    """
    return njit(nogil=True, _nrt=False, **options)  # type: ignore[call-overload]


def plain(kernel: Any) -> Any:
    """The Python function of a kernel, which need not be compiled first; with the JIT off it is one already."""
    return getattr(kernel, "py_func", kernel)


def lowest_bit(word: np.uint64) -> int:
    """Which is the lowest bit of a word that is set; the word must not be 0."""
    return (int(word) & -int(word)).bit_length() - 1


@overload(lowest_bit, inline="always")
def _lowest_bit(word):
    """The same as one instruction, in compiled code."""
    return lambda word: np.int64(trailing_zeros(word))


@njit(inline="always")
def bit_count(word):
    """How many bits of a word are set."""
    pairs = word - ((word >> np.uint64(1)) & np.uint64(0x5555555555555555))
    fours = (pairs & np.uint64(0x3333333333333333)) + (
        (pairs >> np.uint64(2)) & np.uint64(0x3333333333333333)
    )
    bytes_ = (fours + (fours >> np.uint64(4))) & np.uint64(0x0F0F0F0F0F0F0F0F)
    total = bytes_ + (bytes_ >> np.uint64(8))
    total += total >> np.uint64(16)
    return (total + (total >> np.uint64(32))) & np.uint64(0x7F)


class Lattice(NamedTuple):
    """A voxel grid as kernels take it: counts, number of 16-voxel cubes per axis, least corner, edge [m]."""

    nx: int
    ny: int
    nz: int
    cubes_x: int
    cubes_y: int
    cubes_z: int
    x0: float
    y0: float
    z0: float
    edge: float


@njit(inline="always")
def word_of(i, j, k, cubes_y, cubes_z):
    """Index of the uint64 that holds voxel (i, j, k)."""
    cube = ((i >> 4) * cubes_y + (j >> 4)) * cubes_z + (k >> 4)
    return cube * 64 + ((((i >> 2) & 3) * 4 + ((j >> 2) & 3)) * 4 + ((k >> 2) & 3))


@njit(inline="always")
def bit_of(i, j, k):
    """The bit of voxel (i, j, k) within its word."""
    return np.uint64(1) << np.uint64(((i & 3) * 4 + (j & 3)) * 4 + (k & 3))
