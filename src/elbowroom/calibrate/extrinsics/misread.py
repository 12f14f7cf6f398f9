"""Views that show the board far from where other cameras agree that it was.

In tiny images a slanted back passes for a face now and then, or a board at its edge for one that is turned. Such a view
is off by about the board's own size, as no hand that shakes and no camera that was knocked is.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.seen_board import SeenBoard
from elbowroom.geometry import invert_rigid

Array = NDArray[np.float64]
FAR_OFF = 0.5
"""A view is misread if some corner is off by this share of the distance between the board's outermost corners."""
LEAST_WITNESSES = 2
"""Cameras that agree, before another one is said to misread."""
MOST_OF_A_CAMERA = 1 / 3
"""Where more of a camera's views are off, it is the camera that is wrong."""


def misread_views(
    seen: Sequence[SeenBoard],
    base_from_camera: Mapping[str, Array],
    base_from_board: Mapping[int, Array],
    corners: Array,
) -> list[tuple[SeenBoard, float]]:
    """Views that are misread, and how far off they are [m].

    Args:
        seen: all views.
        base_from_camera, base_from_board: first solution, by name and by pose; most views agree with it.
        corners: of the board, shape (n, 3), board frame [m].
    """
    far_m = FAR_OFF * float(np.linalg.norm(np.ptp(corners, axis=0)))
    off_m = [
        _off_m(one, base_from_camera[one.view.camera], base_from_board[one.view.pose], corners)
        for one in seen
    ]
    near: dict[int, int] = defaultdict(int)
    far: dict[int, int] = defaultdict(int)
    far_of_camera: dict[str, int] = defaultdict(int)
    views_of_camera: dict[str, int] = defaultdict(int)
    for one, off in zip(seen, off_m, strict=True):
        (far if off > far_m else near)[one.view.pose] += 1
        far_of_camera[one.view.camera] += off > far_m
        views_of_camera[one.view.camera] += 1
    return [
        (one, off)
        for one, off in zip(seen, off_m, strict=True)
        if off > far_m
        and near[one.view.pose] >= max(LEAST_WITNESSES, far[one.view.pose] + 1)
        and far_of_camera[one.view.camera] <= MOST_OF_A_CAMERA * views_of_camera[one.view.camera]
    ]


def _off_m(one: SeenBoard, base_from_camera: Array, base_from_board: Array, corners: Array) -> float:
    """How far the farthest corner is off, in the pose of the view that suits best."""
    camera_from_board = invert_rigid(base_from_camera) @ base_from_board
    apart = [lone.camera_from_board - camera_from_board for lone in one.lone]
    return min(
        float(np.linalg.norm(corners @ motion[:3, :3].T + motion[:3, 3], axis=1).max()) for motion in apart
    )
