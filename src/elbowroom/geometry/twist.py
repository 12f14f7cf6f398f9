"""Small motions as six numbers: rotation vector [rad], then translation [m], in the frame that moves."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.rigid import cross_matrix, exp, log
from elbowroom.geometry.transforms import invert_rigid

Array = NDArray[Any]
CAMERA_MOTIONS = (
    "tilting up and down",
    "turning left and right",
    "rolling about its line of sight",
    "moving sideways",
    "moving up and down",
    "moving along its line of sight",
)
"""Of the six numbers in a camera's frame, x right, y down, z forward: what the camera does."""


def moved(to_from_frame: Array, twist: Array) -> Array:
    """A pose after its frame has moved: `to_from_frame @ exp(twist)`, shape (4, 4).

    Args:
        to_from_frame: pose, shape (4, 4).
        twist: rotation vector [rad], then translation [m], shape (6,), in the frame.
    """
    return to_from_frame @ exp(twist)


def between(to_from_frame: Array, to_from_moved: Array) -> Array:
    """The twist that brings one pose to another: `moved(to_from_frame, twist) = to_from_moved`, shape (6,)."""
    return log(invert_rigid(to_from_frame) @ to_from_moved)


def adjoint(to_from_frame: Array) -> Array:
    """Matrix that turns a small twist in `frame` into the same motion in `to`, shape (6, 6)."""
    rotation = to_from_frame[:3, :3]
    result = np.zeros((6, 6))
    result[:3, :3] = result[3:, 3:] = rotation
    result[3:, :3] = cross_matrix(to_from_frame[:3, 3]) @ rotation
    return result


def sizes(twist: Array) -> tuple[float, float]:
    """How far a twist moves and turns [m, rad]."""
    return float(np.linalg.norm(twist[3:])), float(np.linalg.norm(twist[:3]))
