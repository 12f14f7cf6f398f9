"""Small motions: exponential and logarithm of rigid transforms; (rotation vector, translation), in that order."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]


def cross_matrix(vectors: Array) -> Array:
    """[v]x, so that [v]x w = v × w; shape (..., 3) to (..., 3, 3)."""
    v = np.asarray(vectors, dtype=np.float64)
    result = np.zeros((*v.shape, 3))
    result[..., 2, 1], result[..., 0, 2], result[..., 1, 0] = v[..., 0], v[..., 1], v[..., 2]
    result[..., 1, 2], result[..., 2, 0], result[..., 0, 1] = -v[..., 0], -v[..., 1], -v[..., 2]
    return result


def exp(motion: Array) -> Array:
    """The rigid transform of a motion.

    Args:
        motion: shape (6,): rotation vector [rad], then translation [m], as of a twist.

    Returns:
        shape (4, 4).
    """
    turn, way = motion[:3], motion[3:]
    result = np.eye(4)
    result[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    result[:3, 3] = _left(turn) @ way
    return result


def log(b_from_a: Array) -> Array:
    """The motion of a rigid transform, shape (4, 4) to (6,); the inverse of `exp`."""
    turn = Rotation.from_matrix(b_from_a[:3, :3]).as_rotvec()
    return np.concatenate([turn, np.linalg.solve(_left(turn), b_from_a[:3, 3])])


def _left(turn: Array) -> Array:
    """The left Jacobian of rotations (Barfoot: State Estimation for Robotics, 2017, eq. 7.37)."""
    angle, k = float(np.linalg.norm(turn)), cross_matrix(turn)
    if angle < 1e-6:
        return np.asarray(np.eye(3) + k / 2 + k @ k / 6)
    return np.asarray(
        np.eye(3) + (1 - np.cos(angle)) / angle**2 * k + (angle - np.sin(angle)) / angle**3 * k @ k
    )
