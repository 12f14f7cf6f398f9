"""The ray of each pixel of a camera, in the camera's frame with z = 1, lens distortion taken out."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import undistorted

CAMERAS_KEPT = 64
"""Rays are kept for this many cameras; those of 640 x 480 take 2.5 MB."""


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


@lru_cache(maxsize=CAMERAS_KEPT)
def pixel_rays(camera: DepthCamera) -> PixelRays:
    """The rays of all pixel centres, kept for the cameras that were asked last.

    Raises:
        CameraError: the lens model folds back within the image, so that pixels have no ray.
    """
    u, v = np.meshgrid(np.arange(float(camera.width)), np.arange(float(camera.height)))
    x, y = undistorted(camera.intrinsics, u, v, f"camera {camera.name}")
    return PixelRays(
        x=x.astype(np.float32),
        y=y.astype(np.float32),
        x_range=np.stack([x.min(axis=0), x.max(axis=0)]),
        y_range=np.stack([y.min(axis=1), y.max(axis=1)]),
    )
