"""Cameras with fewer, larger pixels and the very same field of view."""

import math
from dataclasses import replace

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics


def with_joined_pixels(camera: DepthCamera, least_px: int) -> DepthCamera:
    """The camera with squares of its pixels joined to one, so that its image reaches exactly as far.

    Args:
        camera: any.
        least_px: so many pixels stay across at least, or all if there are fewer.
    """
    common = math.gcd(camera.width, camera.height)
    steps = [n for n in range(1, common + 1) if common % n == 0 and camera.width >= n * least_px]
    step, k = max(steps, default=1), camera.intrinsics
    intrinsics = Intrinsics(
        k.fx / step, k.fy / step, (k.cx + 0.5) / step - 0.5, (k.cy + 0.5) / step - 0.5, k.distortion
    )
    width, height, mask = camera.width // step, camera.height // step, camera.mask
    if mask is not None:
        squares = mask[: height * step, : width * step].reshape(height, step, width, step)
        mask = np.asarray(squares.any(axis=(1, 3)))
    return replace(camera, width=width, height=height, intrinsics=intrinsics, mask=mask)
