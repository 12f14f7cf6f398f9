"""Where cameras stand, from a board that two or more of them see at a time.

views -> each by itself -> graph of cameras and poses -> joint least squares -> poses, covariances
"""

from elbowroom.calibrate.extrinsics.anchor import (
    Anchor,
    BoardAnchor,
    BoardCorner,
    CameraAnchor,
    PointsAnchor,
    SeenPoint,
)
from elbowroom.calibrate.extrinsics.solve import Extrinsics, solve_extrinsics

__all__ = [
    "Anchor",
    "BoardAnchor",
    "BoardCorner",
    "CameraAnchor",
    "Extrinsics",
    "PointsAnchor",
    "SeenPoint",
    "solve_extrinsics",
]
