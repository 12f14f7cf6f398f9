"""Depth images of one camera made ready for fitting: pinhole, along the axis, thinned to the pixels that are needed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import distorted, usable_radius
from elbowroom.sensing import DepthFrame

FITTED_WIDTH_PX = 320
"""Wider images are thinned to about this: every second pixel of 640 columns says all that a pose needs."""
ONE_SURFACE = 0.02
"""Four neighbours whose depths differ by less than this share lie on one surface."""

Depth = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class PlanarImages:
    """What one camera measured, image by image.

    Args:
        camera: as it is, with lens and full size.
        thinned: the pinhole camera that the images below belong to.
        step: every so many pixels of the full image there is one.
        depth_m: distance along the optical axis, shape (n, height, width) of `thinned`, float32 [m]; 0: no return.
    """

    camera: DepthCamera
    thinned: DepthCamera
    step: int
    depth_m: Depth

    def coarser(self, step: int) -> "PlanarImages":
        """The same images with every so many pixels of them."""
        if step == 1:
            return self
        small = thinned(self.thinned, step)
        depth = self.depth_m[:, step // 2 :: step, step // 2 :: step][:, : small.height, : small.width]
        return PlanarImages(self.camera, small, self.step * step, np.ascontiguousarray(depth))

    def at(self, world_from_camera: NDArray[np.float64]) -> DepthCamera:
        """The thinned camera at another place."""
        return replace(self.thinned, world_from_camera=world_from_camera)


def planar_images(camera: DepthCamera, frames: Sequence[DepthFrame], step: int | None = None) -> PlanarImages:
    """Images of a camera without lens distortion, along the axis.

    A pixel of a distorted image is interpolated from the four around its ray, in inverse depth, which is exact on a
    plane; where the four lie on no one surface there is no return.

    Args:
        camera: that took them.
        frames: depth images of the camera's size.
        step: take every so many pixels; None: so many that about `FITTED_WIDTH_PX` columns are left.
    """
    step = step or max(1, round(camera.width / FITTED_WIDTH_PX))
    small = thinned(camera, step)
    look = _look_up(camera, small)
    scale = (
        np.float32(1) if camera.depth_kind == "planar" else (1 / small.radial_over_planar).astype(np.float32)
    )
    depth = np.zeros((len(frames), small.height, small.width), dtype=np.float32)
    for row, frame in enumerate(frames):
        raw = frame.depth_m
        seen = np.bool_(True) if camera.mask is None else ~camera.mask
        valid = seen & (raw > 0) & (raw >= camera.min_depth_m) & (raw <= camera.deepest_m) & (raw < np.inf)
        clean = np.where(valid, raw, np.float32(0))
        depth[row] = (
            _interpolated(clean, *look)
            if look
            else clean[step // 2 :: step, step // 2 :: step][: small.height, : small.width]
        ) * scale
    return PlanarImages(camera, small, step, depth)


def thinned(camera: DepthCamera, step: int, pad: float = 0.0) -> DepthCamera:
    """The pinhole camera whose pixels are every so many of another's, from the middle of the first step on.

    Args:
        camera: any.
        step: at least 1.
        pad: share of the image's size by which it reaches farther on each side.
    """
    k, first = camera.intrinsics, step // 2
    width, height = (camera.width - first - 1) // step + 1, (camera.height - first - 1) // step + 1
    wider, higher = int(pad * width), int(pad * height)
    pinhole = Intrinsics(
        k.fx / step, k.fy / step, (k.cx - first) / step + wider, (k.cy - first) / step + higher
    )
    return replace(camera, width=width + 2 * wider, height=height + 2 * higher, intrinsics=pinhole, mask=None)


def _look_up(camera: DepthCamera, small: DepthCamera) -> tuple[NDArray, ...]:
    """For a distorted camera: first column and row of the four pixels, shares, and whether all are in the image."""
    if not camera.intrinsics.is_distorted:
        return ()
    x, y = np.meshgrid(*small.intrinsics.normalised(small.width, small.height))
    radius = np.hypot(x, y)
    u, v = distorted(camera.intrinsics, x, y)
    inside = radius <= usable_radius(camera.intrinsics, float(radius.max()))
    inside &= (u >= 0) & (v >= 0) & (u < camera.width - 1) & (v < camera.height - 1)
    u, v = np.where(inside, u, 0.0), np.where(inside, v, 0.0)
    left, top = np.floor(u).astype(np.intp), np.floor(v).astype(np.intp)
    return left, top, (u - left).astype(np.float32), (v - top).astype(np.float32), inside


def _interpolated(
    raw: Depth, left: NDArray, top: NDArray, across: NDArray, down: NDArray, inside: NDArray
) -> Depth:
    four = np.stack([raw[top + dv, left + du] for dv in (0, 1) for du in (0, 1)])
    least, greatest = four.min(axis=0), four.max(axis=0)
    usable = inside & (least > 0) & (greatest - least <= ONE_SURFACE * greatest)
    shares = np.stack([(1 - across) * (1 - down), across * (1 - down), (1 - across) * down, across * down])
    inverse = (shares / np.where(four > 0, four, 1)).sum(axis=0)
    return np.where(usable, 1 / inverse, np.float32(0)).astype(np.float32)
