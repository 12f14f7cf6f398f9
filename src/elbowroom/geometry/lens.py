"""OpenCV's lens distortion, forward: where in the raw image a pinhole direction is seen."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import Intrinsics

Array = NDArray[np.float64]
RADIUS_STEPS = 4096


def distorted(intrinsics: Intrinsics, x: Array, y: Array) -> tuple[Array, Array]:
    """The raw pixel that sees a direction, by OpenCV's model (calib3d, "Detailed description").

    Args:
        intrinsics: pinhole and distortion.
        x, y: X/Z and Y/Z of the direction, any shape.

    Returns:
        u, v in the raw image [px], the shape of x. Meaningless beyond `usable_radius`, where the model folds
        back.
    """
    k1, k2, p1, p2, k3, k4, k5, k6 = (*intrinsics.distortion, *(0.0,) * 8)[:8]
    square = x * x + y * y
    radial = (1 + square * (k1 + square * (k2 + square * k3))) / (
        1 + square * (k4 + square * (k5 + square * k6))
    )
    x_distorted = x * radial + 2 * p1 * x * y + p2 * (square + 2 * x * x)
    y_distorted = y * radial + p1 * (square + 2 * y * y) + 2 * p2 * x * y
    return intrinsics.fx * x_distorted + intrinsics.cx, intrinsics.fy * y_distorted + intrinsics.cy


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
    k1, k2, _, _, k3, k4, k5, k6 = (*intrinsics.distortion, *(0.0,) * 8)[:8]
    radius = np.linspace(0.0, widest, RADIUS_STEPS)
    square = radius**2
    denominator = 1 + square * (k4 + square * (k5 + square * k6))
    with np.errstate(divide="ignore", invalid="ignore"):
        grown = radius * (1 + square * (k1 + square * (k2 + square * k3))) / denominator
    fails = (denominator[1:] <= 0) | ~(np.diff(grown) > 0)
    # one step back, since the turn may lie anywhere within the last
    return float(radius[max(int(np.argmax(fails)) - 1, 0)]) if fails.any() else widest
