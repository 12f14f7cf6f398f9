"""The ray of each pixel of a camera, in the camera's frame with z = 1, lens distortion taken out."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics

NEWTON_STEPS = 20
ACCURACY = 1e-10
"""How exactly a ray must distort to its pixel again [in units of X/Z]."""


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
        CameraError: the lens model folds over within the image, so that pixels have no ray.
    """
    x, y = np.meshgrid(*camera.intrinsics.normalised(camera.width, camera.height))
    if camera.intrinsics.is_distorted:
        x, y = undistort(x, y, camera.intrinsics, f"camera {camera.name}")
    return PixelRays(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        x_range=np.stack([x.min(axis=0), x.max(axis=0)]),
        y_range=np.stack([y.min(axis=1), y.max(axis=1)]),
    )


def distort(
    x: NDArray[np.float64], y: NDArray[np.float64], intrinsics: Intrinsics
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """OpenCV's lens model: X/Z and Y/Z of a ray to where the lens puts it, in the same units.

    x' = x (1 + k1 r2 + k2 r4 + k3 r6) / (1 + k4 r2 + k5 r4 + k6 r6) + 2 p1 x y + p2 (r2 + 2 x2), y' alike.
    """
    k1, k2, p1, p2, k3, k4, k5, k6 = (*intrinsics.distortion, *[0.0] * 8)[:8]
    r2 = x * x + y * y
    radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def undistort(
    x_seen: NDArray[np.float64], y_seen: NDArray[np.float64], intrinsics: Intrinsics, what: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The rays that the lens puts at given places, by Newton's method from the place itself.

    Raises:
        CameraError: for some place the method finds no ray.
    """
    x, y = x_seen.copy(), y_seen.copy()
    step = 1e-6
    for _ in range(NEWTON_STEPS):
        at_x, at_y = distort(x, y, intrinsics)
        miss_x, miss_y = x_seen - at_x, y_seen - at_y
        if max(np.abs(miss_x).max(), np.abs(miss_y).max()) < ACCURACY:
            return x, y
        right_x, right_y = distort(x + step, y, intrinsics)
        down_x, down_y = distort(x, y + step, intrinsics)
        xx, yx = (right_x - at_x) / step, (right_y - at_y) / step
        xy, yy = (down_x - at_x) / step, (down_y - at_y) / step
        scale = xx * yy - xy * yx
        scale = np.where(np.abs(scale) < 1e-6, 1e-6, scale)
        x += np.clip((yy * miss_x - xy * miss_y) / scale, -0.5, 0.5)
        y += np.clip((xx * miss_y - yx * miss_x) / scale, -0.5, 0.5)
    raise CameraError(
        f"{what}: distortion {intrinsics.distortion} folds over in the image; no ray leads to some pixels"
    )
