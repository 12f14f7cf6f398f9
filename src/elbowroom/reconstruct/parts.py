"""One voxel looked at again, in parts: the same laws, four times as fine."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.reconstruct.kernels.box import ALL
from elbowroom.reconstruct.kernels.camera import Views
from elbowroom.reconstruct.kernels.parts import ask_parts
from elbowroom.reconstruct.kernels.place import Boxes

PARTS = 4
"""Along each axis a voxel is cut into so many parts: 64 in all, the bits of one word."""
NONE = np.uint64(0)
_LANES = {(i, j, k): 16 * i + 4 * j + k for i in range(PARTS) for j in range(PARTS) for k in range(PARTS)}
EIGHTHS = tuple(
    (_LANES[at], sum(1 << lane for step, lane in _LANES.items() if tuple(n // 2 for n in step) == at))
    for at in _LANES
    if max(at) < 2
)
"""Of the 2 x 2 x 2 eighths of a voxel, its lane among boxes of half the edge, and the word of its parts."""
EIGHT = np.uint64(sum(1 << lane for lane, _ in EIGHTHS))
LATERAL_PX = 0.5
"""By so much pixels are widened at least: what ends between the rays of two pixels ends in some part."""
FINE_PIXEL_M = 0.01
"""Three pixels of this width are no wider than a hand is thick: there parts may be half a pixel wide [m]."""


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


def finest_part_m(pixel_m: float) -> float:
    """How fine parts may be where a pixel is so wide [m]: as a pixel, or as half of one that is fine.

    Parts halves of a pixel wide lose nothing that is wider than a pixel, since pixels are `widened`. What is narrower
    a whole voxel notices more often than its parts do: limbs, in coarse images, and nothing of people in fine ones.
    """
    return pixel_m / 2 if pixel_m <= FINE_PIXEL_M else pixel_m


def free_parts(
    grid: VoxelGrid, index: tuple[int, int, int], kept: Sequence[KeptViews], finest_m: float = 0.0
) -> np.uint64:
    """Which of 64 parts of a voxel are free by rule `three` and the pixel test, as voxels of their size are.

    Where a quarter of the voxel's edge is finer than what is asked for, eight parts at a time are asked as one; where
    half of it is, none are.

    Args:
        grid: the watched box.
        index: of the voxel, (i, j, k).
        kept: images of all of the room's cameras.
        finest_m: no part is finer [m].

    Returns:
        A word: bit (16 i + 4 j + k) is of the part i, j, k steps from the voxel's least corner.
    """
    edge = grid.voxel_size_m / PARTS
    if finest_m <= edge:
        return _free_boxes(grid, index, kept, edge, ALL)
    if finest_m > 2 * edge:
        return NONE
    free = _free_boxes(grid, index, kept, 2 * edge, EIGHT)
    return np.uint64(sum(eighth for lane, eighth in EIGHTHS if int(free) >> lane & 1))


def _free_boxes(
    grid: VoxelGrid, index: tuple[int, int, int], kept: Sequence[KeptViews], edge: float, asked: np.uint64
) -> np.uint64:
    """Which boxes of an edge, counted from the voxel's least corner, are free; a word of 4 x 4 x 4.

    Args:
        grid, index, kept: as of `free_parts`.
        edge: of a box [m].
        asked: those that are asked.
    """
    x, y, z = (grid.lower_m + np.array(index) * grid.voxel_size_m + edge / 2).tolist()
    one = two = three = disputed = NONE
    for group in kept:
        through = np.zeros(len(group.views.cameras), dtype=np.uint64)
        disputed |= np.uint64(ask_parts(group.views, Boxes(x, y, z, edge, 0), asked, through))
        for seen in [np.bitwise_or.reduce(through)] if group.as_one else through:
            one, two, three = one | seen, two | (one & seen), three | (two & seen)
    return np.uint64(three | (one & ~disputed))
