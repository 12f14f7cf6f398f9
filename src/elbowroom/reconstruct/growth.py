"""By how much the machine's body is grown where it is taken out: what cameras cannot tell from it beside its edge."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct.terms import Terms

PITCHES = 1.2
"""So many pixels beside the machine's edge nobody tells from it, besides those that poses may be off."""
MOST_GROWTH_M = 0.015
"""Where pixels are coarser, no more than this, or half a voxel: less than a finger [m]."""


def growth_of(grid: VoxelGrid, cameras: Sequence[DepthCamera], terms: Terms) -> float:
    """By how much the body is grown [m]: what the terms say, else by what a pixel covers, with a quarter voxel.

    It depends on the room's cameras, and on none of their frames: losing one never grows the body.

    Args:
        grid: the watched box; a pixel is as wide as at its middle, of the cameras' median.
        cameras: of the room.
        terms: its growth, or None; and the margin.
    """
    edge = grid.voxel_size_m
    if terms.body_growth_m is not None or not cameras:
        return edge / 2 if terms.body_growth_m is None else terms.body_growth_m
    middle = (np.array(grid.lower_m) + np.array(grid.upper_m)) / 2
    lateral_px = [(camera.margin or terms.margin).lateral_px for camera in cameras]
    beside = (PITCHES + float(np.median(lateral_px))) * pixel_width_m(cameras, middle)
    # where it is taken out, up to a quarter voxel of the growth is lost
    return min(beside + edge / 4, max(edge / 2, MOST_GROWTH_M))


def pixel_width_m(cameras: Sequence[DepthCamera], place_in_world: NDArray[np.float64]) -> float:
    """How wide a pixel is at a place, of the cameras' median [m].

    Args:
        cameras: of the room, one at least.
        place_in_world: shape (3,) [m].
    """
    places, focal_px = _lenses(tuple(cameras))
    return float(np.median(np.linalg.norm(places - place_in_world, axis=1) / focal_px))


@lru_cache(maxsize=16)
def _lenses(cameras: tuple[DepthCamera, ...]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where cameras are, shape (n, 3) [m], and their focal lengths, shape (n,) [px]."""
    focal_px = [max(camera.intrinsics.fx, camera.intrinsics.fy) for camera in cameras]
    return np.array([camera.centre_in_world for camera in cameras]), np.array(focal_px)
