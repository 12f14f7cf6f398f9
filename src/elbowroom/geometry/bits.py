"""Volumes of one bit a voxel, in the order that carving, clearing and sweeping share (docs/conventions.md)."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import GridError
from elbowroom.geometry.grid import VoxelGrid
from elbowroom.geometry.kernels.bits import Lattice, bit_of, plain, word_of

__all__ = ["Words", "empty", "inside", "lattice", "pack", "place_of", "unpack", "word_count"]

Words = NDArray[np.uint64]

_CUBES_FIRST = (0, 3, 6, 1, 4, 7, 2, 5, 8)
"""Per axis cube, block, voxel -> cubes, blocks, voxels; the same order undoes itself."""


def lattice(grid: VoxelGrid) -> Lattice:
    """The grid as kernels take it."""
    nx, ny, nz = grid.shape
    return Lattice(nx, ny, nz, -(-nx // 16), -(-ny // 16), -(-nz // 16), *grid.origin_m, grid.voxel_size_m)


def word_count(grid: VoxelGrid) -> int:
    """Number of uint64 words of one plane: whole 16-voxel cubes, so some bits lie beyond the grid."""
    cells = lattice(grid)
    return cells.cubes_x * cells.cubes_y * cells.cubes_z * 64


def empty(grid: VoxelGrid) -> Words:
    """A plane of zeros: nothing is known of any voxel."""
    return np.zeros(word_count(grid), dtype=np.uint64)


def place_of(index: tuple[int, int, int], grid: VoxelGrid) -> tuple[int, np.uint64]:
    """Where a voxel's bit lies: index of its word, and the bit within it."""
    cells = lattice(grid)
    # not the compiled ones: these would be compiled when first called, perhaps while the machine moves
    return plain(word_of)(*index, cells.cubes_y, cells.cubes_z), plain(bit_of)(*index)


def places_of(
    i: NDArray[np.int64], j: NDArray[np.int64], k: NDArray[np.int64], grid: VoxelGrid
) -> tuple[NDArray[np.int64], Words]:
    """As `place_of` for many voxels: where their words are, and their bits; shapes as of the indices.

    Args:
        i, j, k: indices of the voxels, in the grid.
        grid: the grid.
    """
    cubes = lattice(grid)
    cube = ((i >> 4) * cubes.cubes_y + (j >> 4)) * cubes.cubes_z + (k >> 4)
    word = cube * 64 + (((i >> 2) & 3) * 4 + ((j >> 2) & 3)) * 4 + ((k >> 2) & 3)
    return word, np.uint64(1) << (((i & 3) * 4 + (j & 3)) * 4 + (k & 3)).astype(np.uint64)


def pack(mask: NDArray[np.bool_], grid: VoxelGrid) -> Words:
    """A plane from a bool array of the grid's shape; bits beyond the grid are zero.

    Raises:
        GridError: the array has another shape or is not boolean.
    """
    if mask.shape != grid.shape or mask.dtype != np.bool_:
        raise GridError(f"volume: expected a bool array of shape {grid.shape}, got {mask.dtype} {mask.shape}")
    cells = lattice(grid)
    padded = np.zeros((cells.cubes_x * 16, cells.cubes_y * 16, cells.cubes_z * 16), dtype=np.bool_)
    padded[: grid.shape[0], : grid.shape[1], : grid.shape[2]] = mask
    blocks = padded.reshape((cells.cubes_x, 4, 4, cells.cubes_y, 4, 4, cells.cubes_z, 4, 4))
    ordered = blocks.transpose(_CUBES_FIRST).reshape(-1)
    return np.packbits(ordered, bitorder="little").view(np.uint64)


def unpack(words: Words, grid: VoxelGrid) -> NDArray[np.bool_]:
    """The bool array of the grid's shape that a plane stands for."""
    cells = lattice(grid)
    flat = np.unpackbits(words.view(np.uint8), bitorder="little").view(np.bool_)
    blocks = flat.reshape((cells.cubes_x, cells.cubes_y, cells.cubes_z, 4, 4, 4, 4, 4, 4))
    padded = blocks.transpose(_CUBES_FIRST).reshape(
        cells.cubes_x * 16, cells.cubes_y * 16, cells.cubes_z * 16
    )
    return np.ascontiguousarray(padded[: grid.shape[0], : grid.shape[1], : grid.shape[2]])


@lru_cache(maxsize=8)
def inside(grid: VoxelGrid) -> Words:
    """The plane of all voxels of the grid: ones, but zero beyond it; always the same array, read-only."""
    words = pack(np.ones(grid.shape, dtype=np.bool_), grid)
    words.setflags(write=False)
    return words
