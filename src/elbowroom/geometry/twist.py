"""Small motions as six numbers: rotation vector [rad], then translation [m], in the frame that moves."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def cross_matrix(vectors: Array) -> Array:
    """[v]x, so that [v]x w = v × w; shape (..., 3) to (..., 3, 3)."""
    v = np.asarray(vectors, dtype=np.float64)
    result = np.zeros((*v.shape, 3))
    result[..., 2, 1], result[..., 0, 2], result[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    result[..., 1, 2], result[..., 2, 0], result[..., 0, 1] = -v[..., 0], -v[..., 1], -v[..., 2]
    return result


def exp(twist: Array) -> Array:
    """The rigid transform of a twist.

    Args:
        twist: rotation vector [rad], then translation [m], shape (6,).

    Returns:
        shape (4, 4).
    """
    from scipy.spatial.transform import Rotation  # slow to load, and the cycle needs none

    turn, way = twist[:3], twist[3:]
    result = np.eye(4)
    result[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    result[:3, 3] = _left(turn) @ way
    return result


def log(b_from_a: Array) -> Array:
    """The twist of a rigid transform, shape (4, 4) to (6,); the inverse of `exp`."""
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_matrix(b_from_a[:3, :3]).as_rotvec()
    return np.concatenate([turn, np.linalg.solve(_left(turn), b_from_a[:3, 3])])


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


def _left(turn: Array) -> Array:
    """The left Jacobian of rotations (Barfoot: State Estimation for Robotics, 2017, eq. 7.37)."""
    angle, k = float(np.linalg.norm(turn)), cross_matrix(turn)
    if angle < 1e-6:
        return np.asarray(np.eye(3) + k / 2 + k @ k / 6)
    return np.asarray(
        np.eye(3) + (1 - np.cos(angle)) / angle**2 * k + (angle - np.sin(angle)) / angle**3 * k @ k
    )
