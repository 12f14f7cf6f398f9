"""The rays of cameras' pixels, kept between images."""

from functools import lru_cache

from elbowroom.geometry import DepthCamera
from elbowroom.sensing.rays import PixelRays, pixel_rays


@lru_cache(maxsize=64)
def pixel_rays_of(camera: DepthCamera) -> PixelRays:
    """The rays of a camera's pixels, kept for the cameras that were asked last."""
    return pixel_rays(camera)
