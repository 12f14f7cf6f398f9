"""Cameras with fewer, larger pixels and the very same field of view."""

import math
from dataclasses import replace

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
    return replace(camera, width=camera.width // step, height=camera.height // step, intrinsics=intrinsics)
