"""The ray of each pixel of a camera, in the camera's frame with z = 1, lens distortion taken out."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import distorted, usable_radius

NEWTON_STEPS = 30
LONGEST_STEP = 0.3
STEP = 1e-6
"""Derivatives are taken over this, steps are no longer than that [in X/Z]."""
ACCURACY_PX = 1e-6
"""How exactly a ray must come back to its pixel [px]."""


class PixelRays(NamedTuple):
    """Directions (x, y, 1) of a camera's pixels, so that the length along a ray is planar depth.

    Fields:
        x, y: X/Z and Y/Z, float32, shape (h, w): as exact as the depth that is cast along them.
        x_range: per column the least and greatest X/Z, shape (2, w).
        y_range: per row the least and greatest Y/Z, shape (2, h).
    """

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    x_range: NDArray[np.float64]
    y_range: NDArray[np.float64]


def pixel_rays(camera: DepthCamera) -> PixelRays:
    """The rays of all pixel centres.

    Raises:
        CameraError: the lens model folds back within the image, so that pixels have no ray.
    """
    x, y = np.meshgrid(*camera.intrinsics.normalised(camera.width, camera.height))
    if camera.intrinsics.is_distorted:
        u, v = np.meshgrid(np.arange(float(camera.width)), np.arange(float(camera.height)))
        x, y = undistort(u, v, camera.intrinsics, f"camera {camera.name}")
    return PixelRays(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        x_range=np.stack([x.min(axis=0), x.max(axis=0)]),
        y_range=np.stack([y.min(axis=1), y.max(axis=1)]),
    )


def undistort(
    u: NDArray[np.float64], v: NDArray[np.float64], intrinsics: Intrinsics, what: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The rays that a lens brings to given places of the image, by Newton's method from the pinhole's rays.

    Args:
        u, v: places in the raw image, shape (n, m) [px].
        intrinsics: pinhole and distortion.
        what: the name that an error gives the camera.

    Returns:
        X/Z and Y/Z, shape (n, m).

    Raises:
        CameraError: no ray leads to some place, because the lens model folds back before it.
    """
    x, y = (u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy
    for _ in range(NEWTON_STEPS):
        at_u, at_v = distorted(intrinsics, x, y)
        miss_u, miss_v = u - at_u, v - at_v
        if max(np.abs(miss_u).max(), np.abs(miss_v).max()) < ACCURACY_PX:
            widest = float(np.hypot(x, y).max())
            if usable_radius(intrinsics, 1.01 * widest) < widest:
                break
            return x, y
        right_u, right_v = distorted(intrinsics, x + STEP, y)
        down_u, down_v = distorted(intrinsics, x, y + STEP)
        ux, vx = (right_u - at_u) / STEP, (right_v - at_v) / STEP
        uy, vy = (down_u - at_u) / STEP, (down_v - at_v) / STEP
        area = ux * vy - uy * vx
        area = np.where(np.abs(area) < 1e-3, 1e-3, area)
        x = x + np.clip((vy * miss_u - uy * miss_v) / area, -LONGEST_STEP, LONGEST_STEP)
        y = y + np.clip((ux * miss_v - vx * miss_u) / area, -LONGEST_STEP, LONGEST_STEP)
    raise CameraError(
        f"{what}: distortion {intrinsics.distortion} folds back within the image, so no ray leads to its "
        "corners; use a smaller field of view or coefficients fitted up to the corners"
    )
