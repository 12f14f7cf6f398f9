"""Rigid transforms as 4x4 matrices, named `<to>_from_<from>`."""

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import CameraError, InputError, PoseWarning

RIGID_TOLERANCE = 1e-3
"""How far a pose's rotation may be off the nearest one [greatest entry of |R - R_nearest|]."""
SILENT_DEVIATION = 1e-6
"""Deviations of this size are float noise of a file and are mended without a word."""


def invert_rigid(b_from_a: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inverse of a rigid transform, by transposing its rotation.

    Args:
        b_from_a: shape (..., 4, 4).

    Returns:
        a_from_b, shape (..., 4, 4).
    """
    rotation = np.swapaxes(b_from_a[..., :3, :3], -1, -2)
    a_from_b = np.zeros_like(b_from_a)
    a_from_b[..., :3, :3] = rotation
    a_from_b[..., :3, 3] = -(rotation @ b_from_a[..., :3, 3:])[..., 0]
    a_from_b[..., 3, 3] = 1.0
    return a_from_b


def turn_of_rpy(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """A rotation about the fixed axes x, y and z, one after the other, shape (3, 3), as in URDF (its *joint* page).

    Args:
        roll, pitch, yaw: about x, y and z [rad].
    """
    (si, sj, sk), (ci, cj, ck) = np.sin((roll, pitch, yaw)), np.cos((roll, pitch, yaw))
    return np.array(
        [
            (cj * ck, sj * (si * ck) - ci * sk, sj * (ci * ck) + si * sk),
            (cj * sk, sj * (si * sk) + ci * ck, sj * (ci * sk) - si * ck),
            (-sj, cj * si, cj * ci),
        ]
    )


def nearest_rigid(matrix: ArrayLike, what: str, error: type[InputError] = CameraError) -> NDArray[np.float64]:
    """The rigid transform nearest to a 4x4 matrix that claims to be one.

    Args:
        matrix: shape (4, 4).
        what: the name that an error or a warning gives it.
        error: the class of error to raise.

    Returns:
        A new (4, 4) float64 array whose rotation is exactly orthonormal (polar decomposition by SVD).

    Raises:
        InputError: not 4x4, not finite, last row not (0, 0, 0, 1), mirrored, or off by `RIGID_TOLERANCE` or more.

    Warns:
        PoseWarning: off by less than that, but by more than float noise.
    """
    given = np.array(matrix, dtype=np.float64)
    if given.shape != (4, 4):
        raise error(f"{what}: expected a 4x4 matrix, got shape {given.shape}")
    if not np.isfinite(given).all():
        raise error(f"{what}: contains NaN or infinity; every entry of a pose must be finite")
    if np.abs(given[3] - (0, 0, 0, 1)).max() > RIGID_TOLERANCE:
        turned = np.abs(given[:, 3] - (0, 0, 0, 1)).max() <= RIGID_TOLERANCE
        advice = "; the matrix is written column by column, transpose it" if turned else ""
        raise error(f"{what}: last row is {given[3].tolist()}, must be [0, 0, 0, 1]{advice}")
    u, _, vt = np.linalg.svd(given[:3, :3])
    rotation = u @ vt
    if np.linalg.det(rotation) < 0:
        raise error(f"{what}: mirrors space (determinant below 0); a pose must keep it right-handed")
    deviation = float(np.abs(rotation - given[:3, :3]).max())
    if deviation >= RIGID_TOLERANCE:
        raise error(
            f"{what}: not rigid, off the nearest rotation by {deviation:.2g}; "
            f"less than {RIGID_TOLERANCE:g} is mended, more must be corrected at its source"
        )
    if deviation > SILENT_DEVIATION:
        warnings.warn(
            f"{what}: off a rotation by {deviation:.1e}, brought to the nearest one",
            PoseWarning,
            stacklevel=3,
        )
    rigid = np.eye(4)
    rigid[:3, :3] = rotation
    rigid[:3, 3] = given[:3, 3]
    return rigid


def looking_at(
    position_m: Sequence[float],
    look_at_m: Sequence[float],
    up: Sequence[float] = (0.0, 0.0, 1.0),
    error: type[InputError] = CameraError,
) -> NDArray[np.float64]:
    """Pose of a camera that looks at a point and whose image stands upright.

    Args:
        position_m, look_at_m: where it is and what lies in the middle of its image, world frame [m].
        up: direction that is up in the image, world frame; straight up or down, the image's up is +y.
        error: the class of error to raise.

    Returns:
        world_from_camera, shape (4, 4); x right, y down, z forward.

    Raises:
        InputError: both points are the same, or `up` is no direction.
    """
    forward = np.asarray(look_at_m, dtype=float) - np.asarray(position_m, dtype=float)
    if np.linalg.norm(forward) < 1e-9 or np.linalg.norm(up) < 1e-9:
        raise error(f"position_m {position_m} and look_at_m {look_at_m} give no direction; they must differ")
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, up)
    if np.linalg.norm(right) < 1e-6 * np.linalg.norm(up):
        right = np.cross(forward, (0.0, 1.0, 0.0) if abs(forward[1]) < 0.9 else (1.0, 0.0, 0.0))
    right /= np.linalg.norm(right)
    world_from_camera = np.eye(4)
    world_from_camera[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    world_from_camera[:3, 3] = position_m
    return world_from_camera
