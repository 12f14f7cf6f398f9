"""The images that a free space was made of, kept so that they can be asked again. Nothing is stored per voxel."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.reconstruct.free_space import FreeSpace, Index
from elbowroom.reconstruct.growth import pixel_width_m
from elbowroom.reconstruct.images import Image, RoomImages
from elbowroom.reconstruct.parts import NONE, KeptViews, finest_part_m, free_parts
from elbowroom.reconstruct.point_report import PointReport, Sight
from elbowroom.reconstruct.sight import sight_of, surface_about
from elbowroom.reconstruct.terms import Terms

WILLING = (Sight.HIDDEN, Sight.BLIND, Sight.EDGE, Sight.AGED)
"""What a camera says that would see the voxel if what hides or blinds it were gone, or if its image were newer."""


@dataclass(frozen=True, slots=True, eq=False)
class ImageSource:
    """What a free space was made of, as `FreeSpace.source` asks it.

    Args:
        images: of the room's cameras.
        model_depth: by camera, what the machine explains [m].
        terms: by which space was judged.
        free_words: what was declared free by them: where less is free than that, somebody blocked more, and nothing is
            looked at again.
        focus: blocks of 4 voxels that cameras were asked of, in the planes' order; None: all.
        kept: the images as they were carved; none: no voxel can be looked at again.
    """

    images: RoomImages
    model_depth: Mapping[str, Image]
    terms: Terms
    free_words: Words
    focus: NDArray[np.bool_] | None = None
    kept: tuple[KeptViews, ...] = ()
    _compared: list[tuple[Words, bool]] = field(default_factory=list)

    def report(self, space: FreeSpace, index: Index) -> PointReport:
        """What each camera saw at a voxel, and which camera could settle it."""
        voxel, centre = _alone(space.grid, index)
        seen = sorted(
            (
                sight_of(voxel, centre, self.images.of(camera.name), self.model_depth, self.terms)
                for camera in self.images.cameras
            ),
            key=lambda one: one.distance_m,
        )
        return PointReport(
            index,
            (float(centre[0]), float(centre[1]), float(centre[2])),
            space.state_of(index),
            tuple(seen),
            tuple(one.camera for one in seen if one.sight in WILLING),
        )

    def surface_about(self, grid: VoxelGrid, index: Index) -> dict[str, NDArray[np.float64]]:
        """By camera, what it measured about a voxel, the machine's own apart, shape (n, 3), world frame [m].

        Args:
            grid: of the space.
            index: of the voxel.
        """
        voxel, centre = _alone(grid, index)
        return {
            camera.name: surface_about(voxel, centre, self.images.of(camera.name), self.model_depth)
            for camera in self.images.cameras
        }

    def free_parts(self, space: FreeSpace, index: Index) -> np.uint64:
        """Which of 64 parts of a voxel are free, each judged as a voxel of a quarter of its edge is.

        An object that touches the voxel touches a part of it, so this frees nothing that smaller voxels would not. Less
        evidence leaves fewer parts free, never more.

        Args:
            space: judged by detail `pixel` and rule `three`, and no less free than the images say; else none are. None
                are as well where the terms say that nothing is looked at again.
            index: of the voxel; of one that cameras were not asked of none are. No part is finer than
                `parts.finest_part_m` says of that place.

        Returns:
            A word, as of `parts.free_parts`.
        """
        terms = self.terms
        if not self.kept or not terms.look_again or terms.detail != "pixel" or terms.rule != "three":
            return NONE
        word, _ = bits.place_of(index, space.grid)
        if self._more_is_blocked(space) or not (self.focus is None or self.focus[word]):
            return NONE
        pixel_m = pixel_width_m(self.images.cameras, space.grid.centre_of(np.array(index)))
        return free_parts(space.grid, index, self.kept, finest_part_m(pixel_m))

    def _more_is_blocked(self, space: FreeSpace) -> bool:
        """Whether somebody blocked what the images say is free, such as a zone to keep out of; asked again and again of
        one space."""
        if not self._compared or self._compared[0][0] is not space.free_words:
            more = bool((self.free_words & ~space.free_words).any())
            self._compared[:] = [(space.free_words, more)]
        return self._compared[0][1]


def _alone(grid: VoxelGrid, index: Index) -> tuple[VoxelGrid, NDArray[np.float64]]:
    """A voxel as a grid of its own, and its centre."""
    corner = grid.lower_m + np.array(index) * grid.voxel_size_m
    alone = VoxelGrid((corner[0], corner[1], corner[2]), (1, 1, 1), grid.voxel_size_m)
    return alone, grid.centre_of(np.array(index))
