"""Blocked space near the machine as a box of small whole numbers, as a voxel grid of Foxglove has it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid
from elbowroom.page.scene.near import Near

FIELD = "kind"
SURFACE, UNSEEN, BLIND = 1, 2, 3
"""What a voxel is; 0: free, or not shown."""


@dataclass(frozen=True, slots=True, eq=False)
class Blocked:
    """A part of a grid.

    Args:
        lower: index of its first voxel, shape (3,).
        kinds: uint8, index order x, y, z.
    """

    lower: NDArray[np.int64]
    kinds: NDArray[np.uint8]


def blocked_of(grid: VoxelGrid, near: Near) -> Blocked:
    """The smallest box that holds all that is shown.

    Args:
        grid: of the space.
        near: what is shown of it.
    """
    every = np.concatenate([near.surface, near.unseen, near.blind]).astype(np.int64)
    if not len(every):
        return Blocked(np.zeros(3, dtype=np.int64), np.zeros((1, 1, 1), dtype=np.uint8))
    lower = every.min(axis=0)
    kinds = np.zeros(every.max(axis=0) - lower + 1, dtype=np.uint8)
    for kind, index in ((SURFACE, near.surface), (UNSEEN, near.unseen), (BLIND, near.blind)):
        kinds[tuple((index - lower).T)] = kind
    return Blocked(lower, kinds)
