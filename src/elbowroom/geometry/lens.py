"""OpenCV's lens: where it brings a direction, how that changes with the direction, and back.

The model is that of calib3d, "Detailed description": a direction's x = X/Z and y = Y/Z are bent first, then brought to
pixels by the pinhole. Slopes are derivatives of bent x and y by x and y; bent x changes with y as bent y does with x.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]
RADIUS_STEPS = 4096
NEWTON_STEPS = 30
LONGEST_STEP = 0.3
"""Of a step of Newton's method [in X/Z]."""
STILL, ACCURACY = 1e-12, 1e-8
"""Newton's method ends where bent directions are off by less than the first, and fails if by more than the second."""


class Slopes(NamedTuple):
    """Derivatives of bent directions, each of the directions' shape.

    Fields:
        xx, yy: of bent x by x, and of bent y by y.
        xy: of bent x by y, which is that of bent y by x.
    """

    xx: Array
    xy: Array
    yy: Array


def distorted(intrinsics: Intrinsics, x: Array, y: Array) -> tuple[Array, Array]:
    """The raw pixel that sees a direction.

    Args:
        intrinsics: pinhole and distortion.
        x, y: X/Z and Y/Z of the direction, any shape.

    Returns:
        u, v in the raw image [px], the shape of x. Meaningless beyond `usable_radius`, where the model folds
        back.
    """
    bent_x, bent_y = _bent(intrinsics, x, y)
    return intrinsics.fx * bent_x + intrinsics.cx, intrinsics.fy * bent_y + intrinsics.cy


def undistorted(intrinsics: Intrinsics, u: Array, v: Array, what: str = "lens") -> tuple[Array, Array]:
    """The direction that a raw pixel sees, by Newton's method from the pinhole's direction.

    Args:
        intrinsics: pinhole and distortion.
        u, v: places in the raw image, any shape [px].
        what: the name that an error gives the camera.

    Returns:
        X/Z and Y/Z, the shape of u.

    Raises:
        CameraError: no direction leads to some place, because the lens model folds back before it.
    """
    wanted_x, wanted_y = (u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy
    if not intrinsics.is_distorted or not np.size(u):
        return wanted_x, wanted_y
    x, y = wanted_x, wanted_y
    for _ in range(NEWTON_STEPS):
        bent_x, bent_y = _bent(intrinsics, x, y)
        off_x, off_y = wanted_x - bent_x, wanted_y - bent_y
        slopes = _slopes(intrinsics, x, y)
        area = slopes.xx * slopes.yy - slopes.xy**2
        if np.abs(off_x).max() < STILL and np.abs(off_y).max() < STILL:
            break
        apart = np.where(np.abs(area) < 1e-6, 1e-6, area)
        x = x + np.clip((slopes.yy * off_x - slopes.xy * off_y) / apart, -LONGEST_STEP, LONGEST_STEP)
        y = y + np.clip((slopes.xx * off_y - slopes.xy * off_x) / apart, -LONGEST_STEP, LONGEST_STEP)
    widest = float(np.hypot(x, y).max())
    found = bool(np.abs(off_x).max() < ACCURACY and np.abs(off_y).max() < ACCURACY)
    # beyond where a lens model turns back there are other directions with the same pixel
    if not found or not (area > 0).all() or usable_radius(intrinsics, 1.01 * widest) < widest:
        raise CameraError(
            f"{what}: distortion {intrinsics.distortion} folds back within the image, so no ray leads to its "
            "corners; calibrate intrinsics, or use coefficients fitted up to the corners or a smaller field of view"
        )
    return x, y


def directions(intrinsics: Intrinsics, pixels: Array, what: str = "lens") -> Array:
    """X/Z and Y/Z that raw pixels see.

    Args:
        intrinsics: pinhole and distortion.
        pixels: shape (n, 2) [px].
        what: the name that an error gives the camera.

    Returns:
        shape (n, 2).

    Raises:
        CameraError: as `undistorted`.
    """
    return np.column_stack(undistorted(intrinsics, pixels[:, 0], pixels[:, 1], what))


def project(intrinsics: Intrinsics, points_in_camera: Array) -> tuple[Array, Array]:
    """Pixels that see points, and their derivatives by the points.

    Args:
        intrinsics: pinhole and distortion.
        points_in_camera: shape (n, 3) [m]; before the camera.

    Returns:
        pixels, shape (n, 2) [px]; derivatives, shape (n, 2, 3) [px/m].
    """
    z = points_in_camera[:, 2]
    x, y = points_in_camera[:, 0] / z, points_in_camera[:, 1] / z
    pixels = np.column_stack(distorted(intrinsics, x, y))
    slopes = _slopes(intrinsics, x, y)
    by_point = np.empty((len(z), 2, 3))
    by_point[:, 0, 0], by_point[:, 0, 1] = slopes.xx, slopes.xy
    by_point[:, 1, 0], by_point[:, 1, 1] = slopes.xy, slopes.yy
    by_point[:, :, :2] *= np.array([[intrinsics.fx], [intrinsics.fy]]) / z[:, None, None]
    by_point[:, :, 2] = -(by_point[:, :, 0] * x[:, None] + by_point[:, :, 1] * y[:, None])
    return pixels, by_point


def usable_radius(intrinsics: Intrinsics, widest: float) -> float:
    """Radius sqrt(x^2 + y^2) up to which the radial model grows, so that no two directions share a raw pixel.

    Polynomials fitted to the middle of a lens turn back farther out. A direction out there would be looked up
    in a part of the image that shows something else.

    Args:
        intrinsics: pinhole and distortion.
        widest: radius up to which to look.

    Returns:
        `widest`, or the last radius before the model stops growing or its denominator reaches zero.
    """
    radius = np.linspace(0.0, widest, RADIUS_STEPS)
    over, under = _radial(intrinsics, radius**2)
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = radius * over / under
    fails = (under[1:] <= 0) | ~(np.diff(grown) > 0)
    # one step back, since the turn may lie anywhere within the last
    return float(radius[max(int(np.argmax(fails)) - 1, 0)]) if fails.any() else widest


def _coefficients(intrinsics: Intrinsics) -> tuple[float, ...]:
    return (*intrinsics.distortion, *(0.0,) * 8)[:8]


def _radial(intrinsics: Intrinsics, square: Array) -> tuple[Array, Array]:
    """Numerator and denominator of the radial factor at x^2 + y^2."""
    k1, k2, _, _, k3, k4, k5, k6 = _coefficients(intrinsics)
    return 1 + square * (k1 + square * (k2 + square * k3)), 1 + square * (k4 + square * (k5 + square * k6))


def _bent(intrinsics: Intrinsics, x: Array, y: Array) -> tuple[Array, Array]:
    """Directions as distortion bends them, before the pinhole."""
    _, _, p1, p2, *_ = _coefficients(intrinsics)
    square = x * x + y * y
    over, under = _radial(intrinsics, square)
    radial = over / under
    return (
        x * radial + 2 * p1 * x * y + p2 * (square + 2 * x * x),
        y * radial + p1 * (square + 2 * y * y) + 2 * p2 * x * y,
    )


def _slopes(intrinsics: Intrinsics, x: Array, y: Array) -> Slopes:
    """Derivatives of `_bent`."""
    k1, k2, p1, p2, k3, k4, k5, k6 = _coefficients(intrinsics)
    square = x * x + y * y
    over, under = _radial(intrinsics, square)
    radial = over / under
    by_square = (
        k1 + square * (2 * k2 + 3 * square * k3) - radial * (k4 + square * (2 * k5 + 3 * square * k6))
    ) / under
    return Slopes(
        radial + 2 * x * x * by_square + 2 * p1 * y + 6 * p2 * x,
        2 * x * y * by_square + 2 * p1 * x + 2 * p2 * y,
        radial + 2 * y * y * by_square + 6 * p1 * y + 2 * p2 * x,
    )
