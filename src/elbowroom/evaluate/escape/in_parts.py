"""The truth in voxels, of which each can be asked again in parts, as images are."""

from dataclasses import dataclass

import numpy as np

from elbowroom.errors import EvidenceError
from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct import FreeSpace, PointReport
from elbowroom.reconstruct.free_space import Index
from elbowroom.reconstruct.parts import PARTS
from elbowroom.simulate import Solid
from elbowroom.simulate.truth import touched_by


@dataclass(frozen=True, slots=True, eq=False)
class TrueParts:
    """What stands in a room, as `FreeSpace.source` is asked: a part is free if no solid touches it.

    Args:
        solids: closed.
    """

    solids: tuple[Solid, ...]

    def report(self, space: FreeSpace, index: Index) -> PointReport:
        """Nobody saw anything.

        Args:
            space, index: of which voxel.

        Raises:
            EvidenceError: always.
        """
        raise EvidenceError("explain: this space was made of the truth, not of frames of cameras")

    def free_parts(self, space: FreeSpace, index: Index) -> np.uint64:
        """Which of 64 parts of a voxel no solid touches.

        Args:
            space: of which.
            index: of the voxel.

        Returns:
            A word, as of `FreeSpace.free_parts`.
        """
        edge = space.grid.voxel_size_m
        x, y, z = (space.grid.lower_m + np.array(index) * edge).tolist()
        parts = VoxelGrid((x, y, z), (PARTS,) * 3, edge / PARTS)
        free = np.ones(parts.shape, dtype=np.bool_)
        for solid in self.solids:
            first, touched = touched_by(parts, solid)
            free[tuple(slice(n, n + size) for n, size in zip(first, touched.shape, strict=True))] &= ~touched
        word: np.uint64 = np.packbits(free.reshape(-1), bitorder="little").view(np.uint64)[0]
        return word
