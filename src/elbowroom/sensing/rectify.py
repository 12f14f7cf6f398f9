"""A distorted image brought to a pinhole image, so that nothing near is lost and nothing far is invented."""

from dataclasses import replace
from functools import lru_cache, reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import FrameError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import distorted, usable_radius
from elbowroom.sensing.frame import DepthFrame
from elbowroom.sensing.kernels.rectify import bounds_of_contributors

SLACK_PX = 1e-3
"""Added around the mapped square of a pixel, above what its curved edges need [px]."""
CAMERAS_KEPT = 64
"""Index maps are kept for this many cameras; one of 640 x 480 takes 2.5 MB."""

Depth = NDArray[np.float32]


class IndexMap(NamedTuple):
    """Per pinhole pixel the rectangle of raw pixels that overlap it, ends included; first_u = -1: none."""

    first_u: NDArray[np.int16]
    last_u: NDArray[np.int16]
    first_v: NDArray[np.int16]
    last_v: NDArray[np.int16]


def rectified(camera: DepthCamera) -> DepthCamera:
    """The pinhole twin of a camera: the same name, size, pose and focal lengths, no distortion.

    A pinhole pixel is masked if any raw pixel is that contributes to it.
    """
    k = camera.intrinsics
    pinhole = Intrinsics(fx=k.fx, fy=k.fy, cx=k.cx, cy=k.cy)
    return replace(camera, intrinsics=pinhole, mask=_mask_of(camera))


def rectify(camera: DepthCamera, frame: DepthFrame) -> tuple[DepthCamera, Depth, Depth]:
    """The nearest and farthest that a pinhole camera in this place could have measured, per pixel.

    Every raw pixel whose cone overlaps a pinhole pixel's cone contributes to it. A pixel with a contributor
    that has no return, lies outside the camera's range of depth or outside the raw image is no return.
    Without distortion the two are the same image. Depth keeps its kind: planar stays planar, radial stays
    radial.

    Args:
        camera: the camera that took the frame.
        frame: its depth image.

    Returns:
        The pinhole camera; least and greatest depth, shape (height, width), float32 [m, the camera's kind of
        depth], 0 in both where there is no return.

    Raises:
        FrameError: the frame is of another camera, or of another size than the camera's.
    """
    if frame.camera != camera.name:
        raise FrameError(f"frame of {frame.camera}: given for camera {camera.name}")
    if frame.depth_m.shape != (camera.height, camera.width):
        raise FrameError(
            f"frame of {camera.name}: image is {frame.depth_m.shape[1]} x {frame.depth_m.shape[0]} pixels, "
            f"its camera has {camera.width} x {camera.height}"
        )
    if not camera.intrinsics.is_distorted:
        depth = _valid_only(frame.depth_m, camera.min_depth_m, camera.deepest_m)
        return rectified(camera), depth, depth
    least, greatest = np.empty_like(frame.depth_m), np.empty_like(frame.depth_m)
    index_map = index_map_of(camera.intrinsics, camera.width, camera.height)
    bounds_of_contributors(frame.depth_m, index_map, camera.min_depth_m, camera.deepest_m, least, greatest)
    return rectified(camera), least, greatest


def _valid_only(depth_m: Depth, shallowest_m: float, deepest_m: float) -> Depth:
    valid = (depth_m > 0) & (depth_m >= shallowest_m) & (depth_m <= deepest_m) & (depth_m < np.inf)
    return np.where(valid, depth_m, np.float32(0))


def _mask_of(camera: DepthCamera) -> NDArray[np.bool_] | None:
    """The mask of a camera's pinhole image."""
    if camera.mask is None or not camera.intrinsics.is_distorted:
        return camera.mask
    first_u, last_u, first_v, last_v = index_map_of(camera.intrinsics, camera.width, camera.height)
    # how many masked pixels lie above and to the left of each corner
    above = np.pad(camera.mask.astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    inside = above[last_v + 1, last_u + 1] - above[first_v, last_u + 1]
    inside += above[first_v, first_u] - above[last_v + 1, first_u]
    return (first_u >= 0) & (inside > 0)


@lru_cache(maxsize=CAMERAS_KEPT)
def index_map_of(intrinsics: Intrinsics, width: int, height: int) -> IndexMap:
    """The raw pixels behind each pinhole pixel; computed once per intrinsics and size.

    Each pixel's square is mapped at its corners, the middles of its edges and its centre. The bounding
    rectangle of these is widened by twice the edges' greatest bend, which bounds what a smooth edge does
    between them.

    Args:
        intrinsics: with distortion.
        width, height: size of both images [px].

    Returns:
        Rectangles of raw pixels, each array of shape (height, width), int16.
    """
    # samples half a pixel apart, from the first pixel's outer edge to the last one's
    x = (np.arange(2 * width + 1) / 2 - 0.5 - intrinsics.cx) / intrinsics.fx
    y = (np.arange(2 * height + 1) / 2 - 0.5 - intrinsics.cy) / intrinsics.fy
    grid_x, grid_y = np.meshgrid(x, y)
    radius = np.hypot(grid_x, grid_y)
    usable = radius <= usable_radius(intrinsics, float(radius.max()))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        u, v = distorted(intrinsics, grid_x, grid_y)
        usable &= _keeps_orientation(u, v)
    first_u, last_u = _span(u)
    first_v, last_v = _span(v)
    seen = _over_squares(usable, np.logical_and)
    # comparisons as floats, and so that NaN fails them, before anything is cast
    seen &= (first_u >= 0) & (last_u <= width - 1) & (first_v >= 0) & (last_v <= height - 1)
    arrays = [np.where(seen, edge, -1).astype(np.int16) for edge in (first_u, last_u, first_v, last_v)]
    for array in arrays:
        array.setflags(write=False)
    return IndexMap(*arrays)


def _samples(lattice: NDArray) -> list[list[NDArray]]:
    """The 3 x 3 samples of each pixel's square, rows by columns, each of shape (height, width)."""
    rows, columns = lattice.shape[0] - 2, lattice.shape[1] - 2
    return [[lattice[r : r + rows : 2, c : c + columns : 2] for c in range(3)] for r in range(3)]


def _over_squares(lattice: NDArray, combine: np.ufunc) -> NDArray:
    """One value per pixel from the nine samples of its square."""
    return reduce(combine, [sample for row in _samples(lattice) for sample in row])


def _span(lattice: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First and last raw pixel, per pinhole pixel along one axis, whose +-0.5 meets the mapped square."""
    s = _samples(lattice)
    lines = [*s, *([s[0][c], s[1][c], s[2][c]] for c in range(3))]
    bend = reduce(np.maximum, (np.abs(middle - (a + b) / 2) for a, middle, b in lines))
    slack = 2 * bend + SLACK_PX
    first = np.floor(_over_squares(lattice, np.minimum) - slack + 0.5)
    last = np.ceil(_over_squares(lattice, np.maximum) + slack - 0.5)
    return first, last


def _keeps_orientation(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Where the mapping neither folds nor mirrors: its Jacobian's determinant is above zero."""
    u_down, u_right = np.gradient(u)
    v_down, v_right = np.gradient(v)
    return np.asarray(u_right * v_down - u_down * v_right > 0)
