"""Where a lens puts points, with derivatives, and back: pinhole and OpenCV's distortion."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError
from elbowroom.geometry import Intrinsics

Array = NDArray[np.float64]
STEPS = 20
"""Of Newton's method, at most."""


def bent(k: Intrinsics, x: Array, y: Array) -> tuple[Array, Array]:
    """Distorted coordinates before the pinhole, and their derivatives by x and y (calib3d, "Detailed description").

    Args:
        k: of which only the distortion is used.
        x, y: X/Z and Y/Z, shape (n,).

    Returns:
        shape (n, 2), and shape (n, 2, 2).
    """
    at, slope = np.empty((len(x), 2)), np.zeros((len(x), 2, 2))
    if not k.is_distorted:
        at[:, 0], at[:, 1] = x, y
        slope[:, 0, 0] = slope[:, 1, 1] = 1.0
        return at, slope
    k1, k2, p1, p2, k3, k4, k5, k6 = (*k.distortion, *(0.0,) * 8)[:8]
    r = x * x + y * y
    over, under = 1 + r * (k1 + r * (k2 + r * k3)), 1 + r * (k4 + r * (k5 + r * k6))
    s = over / under
    by_r = (k1 + r * (2 * k2 + 3 * r * k3) - s * (k4 + r * (2 * k5 + 3 * r * k6))) / under
    at[:, 0] = x * s + 2 * p1 * x * y + p2 * (r + 2 * x * x)
    at[:, 1] = y * s + p1 * (r + 2 * y * y) + 2 * p2 * x * y
    slope[:, 0, 0] = s + 2 * x * x * by_r + 2 * p1 * y + 6 * p2 * x
    slope[:, 1, 1] = s + 2 * y * y * by_r + 6 * p1 * y + 2 * p2 * x
    slope[:, 0, 1] = slope[:, 1, 0] = 2 * x * y * by_r + 2 * p1 * x + 2 * p2 * y
    return at, slope


def project(k: Intrinsics, points_in_camera: Array) -> tuple[Array, Array]:
    """Pixels that see points, and their derivatives by the points.

    Args:
        k: intrinsics.
        points_in_camera: shape (n, 3) [m]; before the camera.

    Returns:
        pixels, shape (n, 2) [px]; derivatives, shape (n, 2, 3) [px/m].
    """
    z = points_in_camera[:, 2]
    x, y = points_in_camera[:, 0] / z, points_in_camera[:, 1] / z
    at, slope = bent(k, x, y)
    f = np.array([k.fx, k.fy])
    by_point = np.empty((len(z), 2, 3))
    by_point[:, :, :2] = slope * (f[:, None] / z[:, None, None])
    by_point[:, :, 2] = -(by_point[:, :, 0] * x[:, None] + by_point[:, :, 1] * y[:, None])
    return at * f + (k.cx, k.cy), by_point


def directions(k: Intrinsics, pixels: Array) -> Array:
    """X/Z and Y/Z that raw pixels see, by Newton's method, shape (n, 2).

    Args:
        k: intrinsics.
        pixels: shape (n, 2) [px].

    Raises:
        CalibrationError: a pixel that the lens model has no direction for.
    """
    wanted = (pixels - (k.cx, k.cy)) / (k.fx, k.fy)
    if not k.is_distorted or not len(pixels):
        return wanted
    found = wanted.copy()
    for _ in range(STEPS):
        at, slope = bent(k, found[:, 0], found[:, 1])
        off = at - wanted
        if np.abs(off).max() < 1e-12:
            break
        found -= np.linalg.solve(slope, off[:, :, None])[:, :, 0]
    # beyond where a lens model turns back there are other directions with the same pixel
    folded = (np.linalg.det(slope) <= 0) | ((at * found).sum(axis=1) < -1e-12)
    if not np.abs(off).max() < 1e-6 or folded.any():
        raise CalibrationError(
            "lens: distortion coefficients have no direction for some pixels of the image; calibrate intrinsics first"
        )
    return found
