"""Where the boxes of a carve lie: cubes of 16 voxels, their 64 blocks of 4, and the 64 voxels of each."""

from typing import NamedTuple

import numpy as np
from numba import njit

VOXELS, BLOCKS = np.int64(0), np.int64(1)
"""Scales of boxes, as `kernels.camera.CAMERA` counts them."""


class Cube(NamedTuple):
    """A cube of 16 voxels: its first word, its least corner in the world [m], a voxel's edge [m]."""

    word: int
    x: float
    y: float
    z: float
    edge: float


class Boxes(NamedTuple):
    """Boxes of 4 x 4 x 4, box (i, j, k) in lane 16 i + 4 j + k: the first one's centre in the world, their edge [m],
    and their scale."""

    x: float
    y: float
    z: float
    edge: float
    scale: int


class Box(NamedTuple):
    """One box: its centre in the world and its edge [m]."""

    x: float
    y: float
    z: float
    edge: float


@njit(inline="always")
def cube_at(lattice, cube):
    """Cube number `cube` of a grid."""
    edge = lattice.edge
    return Cube(
        cube * 64,
        lattice.x0 + (cube // (lattice.cubes_y * lattice.cubes_z)) * 16 * edge,
        lattice.y0 + ((cube // lattice.cubes_z) % lattice.cubes_y) * 16 * edge,
        lattice.z0 + (cube % lattice.cubes_z) * 16 * edge,
        edge,
    )


@njit(inline="always")
def blocks_of(cube):
    """The blocks of a cube."""
    edge = 4.0 * cube.edge
    # not a literal: numba would compile all that is handed it once for each scale
    return Boxes(cube.x + 0.5 * edge, cube.y + 0.5 * edge, cube.z + 0.5 * edge, edge, np.int64(BLOCKS))


@njit(inline="always")
def voxels_of(cube, lane):
    """The voxels of the block in a lane of a cube."""
    return Boxes(
        cube.x + ((lane >> 4) * 4 + 0.5) * cube.edge,
        cube.y + (((lane >> 2) & 3) * 4 + 0.5) * cube.edge,
        cube.z + ((lane & 3) * 4 + 0.5) * cube.edge,
        cube.edge,
        np.int64(VOXELS),
    )


@njit(inline="always")
def box_in(boxes, lane):
    """The box in one lane."""
    return Box(
        boxes.x + (lane >> 4) * boxes.edge,
        boxes.y + ((lane >> 2) & 3) * boxes.edge,
        boxes.z + (lane & 3) * boxes.edge,
        boxes.edge,
    )
