"""A camera's uncertain direction in words."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.twist import CAMERA_MOTIONS

RANGE_M = 2.5
"""At this distance a rotation is compared with a shift [m]."""


def deviations(covariance: NDArray[np.float64]) -> tuple[float, float]:
    """The greatest standard deviation in any direction: of place [m], of rotation [rad]."""
    return (
        float(np.sqrt(max(np.linalg.eigvalsh(covariance[3:, 3:]).max(), 0.0))),
        float(np.sqrt(max(np.linalg.eigvalsh(covariance[:3, :3]).max(), 0.0))),
    )


def weakest_words(covariance: NDArray[np.float64]) -> str:
    """What the camera could still do without being noticed: the main part of the least certain direction."""
    scale = np.array([RANGE_M] * 3 + [1.0] * 3)
    _, vectors = np.linalg.eigh(covariance * np.outer(scale, scale))
    parts = np.abs(vectors[:, -1])
    first, second = np.argsort(-parts)[:2]
    if parts[second] > 0.6 * parts[first]:
        return f"{CAMERA_MOTIONS[first]} together with {CAMERA_MOTIONS[second]}"
    return CAMERA_MOTIONS[first]
