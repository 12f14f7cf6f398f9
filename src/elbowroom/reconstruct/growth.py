"""By how much the machine's body is grown where it is taken out: what cameras cannot tell from it beside its edge."""

from collections.abc import Sequence

import numpy as np

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
    beside = [
        (PITCHES + (camera.margin or terms.margin).lateral_px)
        * float(np.linalg.norm(camera.centre_in_world - middle))
        / max(camera.intrinsics.fx, camera.intrinsics.fy)
        for camera in cameras
    ]
    # where it is taken out, up to a quarter voxel of the growth is lost
    return min(float(np.median(beside)) + edge / 4, max(edge / 2, MOST_GROWTH_M))
