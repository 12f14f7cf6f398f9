"""Voxels that are known cell by cell: links reach into them where they stand, or cameras were asked of their parts.

A cell is a part of a voxel, `CELLS` along each axis; a voxel's cells are one cube of 64 words
(`geometry.kernels.bits`).
"""

from typing import NamedTuple

import numpy as np

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.motion.kernels.triangles import triangle_meets_box

CELLS = 16
"""Along each axis of a voxel."""
WORDS = 64
"""Of the cells of one voxel."""


class Shared(NamedTuple):
    """Blocked voxels that are known cell by cell, n of them.

    Fields:
        numbers: of the voxels, (i ny + j) nz + k, rising, (n,) int64.
        links: whether each link reaches into each where it stands, (n, links) bool.
        cells: of each voxel those that are blocked, (n, 64) uint64.
        others: whom they block: links that do not reach into them, and what is not here blocks all; or, if not, links
            that do, and nothing else blocks.
    """

    numbers: np.ndarray
    links: np.ndarray
    cells: np.ndarray
    others: bool


@uncounted()
def row_of(shared, number):
    """The row of a voxel, -1 if it is not known cell by cell."""
    low, high = 0, shared.numbers.size
    while low < high:
        middle = (low + high) >> 1
        if shared.numbers[middle] < number:
            low = middle + 1
        else:
            high = middle
    return low if low < shared.numbers.size and shared.numbers[low] == number else -1


@uncounted()
def triangle_meets_cells(triangle, cells, x, y, z, edge, grown):
    """Whether a triangle, grown, meets any of a voxel's blocked cells.

    Args:
        triangle: (3, 3), world frame [m].
        cells: of the voxel, (64,).
        x, y, z: least corner of the voxel [m].
        edge: of the voxel [m].
        grown: by how much [m].
    """
    block, cell = edge / 4, edge / CELLS
    for word in range(WORDS):
        left = cells[word]
        if left == 0:
            continue
        a, b, c = word >> 4, (word >> 2) & 3, word & 3
        if not triangle_meets_box(
            triangle,
            x + (a + 0.5) * block,
            y + (b + 0.5) * block,
            z + (c + 0.5) * block,
            block / 2 + grown,
        ):
            continue
        if ~left == 0:
            return True
        for bit in range(64):
            if not left & (np.uint64(1) << np.uint64(bit)):
                continue
            i, j, k = 4 * a + (bit >> 4), 4 * b + ((bit >> 2) & 3), 4 * c + (bit & 3)
            if triangle_meets_box(
                triangle,
                x + (i + 0.5) * cell,
                y + (j + 0.5) * cell,
                z + (k + 0.5) * cell,
                cell / 2 + grown,
            ):
                return True
    return False
