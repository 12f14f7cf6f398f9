"""Views that took the board's back for its face, as happens in tiny images: the other cameras tell."""

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.extrinsics.seen_board import SeenBoard
from elbowroom.geometry import invert_rigid

Array = NDArray[np.float64]
LEAST_WITNESSES = 2
"""Cameras that see the face, before another one is said to see the back."""
BEHIND_DEG = 10.0
"""So far behind the board's plane a camera surely sees its back."""


def misread_backs(
    seen: Sequence[SeenBoard], base_from_camera: Mapping[str, Array], base_from_board: Mapping[int, Array]
) -> list[SeenBoard]:
    """Views from behind the board, where at least two cameras, and more than see it from there, are before it.

    Args:
        seen: all views; each says that it shows the face.
        base_from_camera, base_from_board: first solution, by name and by pose; most views agree with it.
    """
    by_pose: dict[int, list[SeenBoard]] = defaultdict(list)
    for one in seen:
        by_pose[one.view.pose].append(one)
    backs: list[SeenBoard] = []
    for pose, views in by_pose.items():
        board_from_base = invert_rigid(base_from_board[pose])
        behind = [_behind(board_from_base @ base_from_camera[one.view.camera], one.corners) for one in views]
        if len(views) - sum(behind) >= max(LEAST_WITNESSES, sum(behind) + 1):
            backs += [one for one, back in zip(views, behind, strict=True) if back]
    return backs


def _behind(board_from_camera: Array, corners: Array) -> bool:
    """The board's z axis points away from who sees its face."""
    sight = board_from_camera[:3, 3] - corners.mean(axis=0)
    return float(sight[2]) > np.sin(np.radians(BEHIND_DEG)) * float(np.linalg.norm(sight))
