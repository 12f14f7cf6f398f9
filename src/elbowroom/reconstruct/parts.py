"""One voxel looked at again, in parts: the same laws, four times as fine."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct.kernels.camera import Views
from elbowroom.reconstruct.kernels.parts import ask_parts
from elbowroom.reconstruct.kernels.place import Boxes

PARTS = 4
"""Along each axis a voxel is cut into so many parts: 64 in all, the bits of one word."""
NONE = np.uint64(0)
LATERAL_PX = 0.5
"""By so much pixels are widened at least: what ends between the rays of two pixels ends in some part."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class KeptViews:
    """The images of cameras that were carved together, as kernels take them, kept to be asked again.

    Args:
        views: of the cameras, `widened`.
        as_one: whether they are one witness; else each is one of its own.
    """

    views: Views
    as_one: bool


def widened(views: Views) -> Views:
    """The same with pixels as wide as parts need them."""
    cameras = views.cameras.copy()
    lateral_px = np.maximum(cameras["lateral_px"], LATERAL_PX)
    cameras["ray_half_width"] *= ((0.5 + lateral_px) / (0.5 + cameras["lateral_px"]))[:, None]
    cameras["lateral_px"] = lateral_px
    return views._replace(cameras=cameras)


def free_parts(grid: VoxelGrid, index: tuple[int, int, int], kept: Sequence[KeptViews]) -> np.uint64:
    """Which of 64 parts of a voxel are free by rule `three` and the pixel test, as voxels of a quarter of its edge are.

    Args:
        grid: the watched box.
        index: of the voxel, (i, j, k).
        kept: images of all of the room's cameras.

    Returns:
        A word: bit (16 i + 4 j + k) is of the part i, j, k steps from the voxel's least corner.
    """
    edge = grid.voxel_size_m / PARTS
    x, y, z = (grid.lower_m + np.array(index) * grid.voxel_size_m + edge / 2).tolist()
    one = two = three = disputed = NONE
    for group in kept:
        through = np.zeros(len(group.views.cameras), dtype=np.uint64)
        disputed |= np.uint64(ask_parts(group.views, Boxes(x, y, z, edge, 0), through))
        for seen in [np.bitwise_or.reduce(through)] if group.as_one else through:
            one, two, three = one | seen, two | (one & seen), three | (two & seen)
    return np.uint64(three | (one & ~disputed))
