"""One voxel looked at again, in parts: what no one camera sees all of, several may see between them."""

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.images import Image, RoomImages
from elbowroom.reconstruct.kernels import pyramid as pyramid
from elbowroom.reconstruct.kernels.aged import still_through
from elbowroom.reconstruct.kernels.box import ALL
from elbowroom.reconstruct.kernels.camera import Texels
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.pixel import settle_word
from elbowroom.reconstruct.kernels.place import Boxes
from elbowroom.reconstruct.layout import Layout, layout_of
from elbowroom.reconstruct.records import cut_out
from elbowroom.reconstruct.views import NO_TEXELS, put_mask, texels_of

PARTS = 4
"""Along each axis a voxel is cut into so many parts: 64 in all, the bits of one word."""
RIM = np.array([(0, 0, 1), (-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0)], dtype=float)
"""Points of a ball about the origin of a camera's axes."""
SPARE_PX = 6
"""Of an image, so many pixels around those that meet the voxel are cut out as well: more than filters reach."""
NEAREST_M = 1e-3
"""A camera whose plane comes as near to the voxel as this is not asked [m]."""
STEPS = np.stack(np.meshgrid(*[range(PARTS)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
"""From the first part to each, in parts, in the order of bits."""
CORNERS = np.flatnonzero((STEPS % (PARTS - 1) == 0).all(axis=1))
"""The parts in the corners of the voxel."""


def is_seen_in_parts(
    grid: VoxelGrid,
    index: tuple[int, int, int],
    images: RoomImages,
    model_depth: Mapping[str, Image],
    margin: Margin,
) -> bool:
    """Whether each of 64 parts of a voxel is seen through by some camera, by the pixel test, as a voxel is.

    Args:
        grid: the watched box.
        index: of the voxel, (i, j, k).
        images: of the room's cameras.
        model_depth: by camera, what the machine explains [m].
        margin: of cameras without one of their own.
    """
    edge = grid.voxel_size_m / PARTS
    first = grid.lower_m + np.array(index) * grid.voxel_size_m + edge / 2
    in_cameras = _in_cameras(images.cameras, first + STEPS * edge)
    maybe = _may_be_seen(images, model_depth, in_cameras)
    if images.aged_m:
        maybe = _may_be_seen_grown(images, model_depth, in_cameras, maybe)
    # first the camera that may see most
    rows = np.argsort(-maybe.sum(axis=1), kind="stable")
    seen = np.zeros(len(STEPS), dtype=np.bool_)
    for position, row in enumerate(rows):
        if not (seen | maybe[rows[position:]].any(axis=0)).all():
            return False
        layout, name = layout_of(grid, images.cameras, margin), images.cameras[row].name
        bounds_m = images.least_m[name], images.greatest_m[name]
        parts = _Parts(first, edge, in_cameras[row], images.aged_m.get(name, 0.0))
        seen |= _parts_seen(layout, row, bounds_m, model_depth.get(name), parts)
        if seen.all():
            return True
    return False


class _Parts(NamedTuple):
    """The parts of a voxel before a camera.

    Args:
        first: centre of the first, world frame [m].
        edge: of a part [m].
        in_camera: centres of all parts in the camera's axes, shape (3, parts) [m].
        aged_m: how far anything may have moved since the camera's image [m].
    """

    first: NDArray[np.float64]
    edge: float
    in_camera: NDArray[np.float64]
    aged_m: float

    @property
    def corners(self) -> NDArray[np.float64]:
        """Of the voxel, in the camera's axes, shape (3, 8) [m]."""
        middle = self.in_camera.mean(axis=1, keepdims=True)
        return middle + (self.in_camera[:, CORNERS] - middle) * PARTS / (PARTS - 1)


def _in_cameras(cameras: tuple[DepthCamera, ...], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points in the axes of each camera, shape (cameras, 3, points) [m]."""
    poses = _camera_from_world(cameras)
    return poses[:, :3, :3] @ points.T + poses[:, :3, 3:]


@lru_cache(maxsize=8)
def _camera_from_world(cameras: tuple[DepthCamera, ...]) -> NDArray[np.float64]:
    return np.array([camera.camera_from_world for camera in cameras]).reshape(-1, 4, 4)


@lru_cache(maxsize=8)
def _lenses(cameras: tuple[DepthCamera, ...]) -> NDArray[np.float64]:
    """fx, fy, cx, cy, width and height of each camera, shape (cameras, 6, 1) [px]."""
    lenses = [(c.intrinsics, c.width, c.height) for c in cameras]
    return np.array([(k.fx, k.fy, k.cx, k.cy, w, h) for k, w, h in lenses]).reshape(-1, 6, 1)


def _may_be_seen(
    images: RoomImages, model_depth: Mapping[str, Image], in_cameras: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """By camera and part, whether the pixel at the part's centre may be free beyond it, shape (cameras, parts).

    A camera sees through no other part: a pixel is free no farther than it measured, than the machine's model in it,
    or, if it is a speck, than the pixels beside it.
    """
    x, y, z = np.moveaxis(in_cameras, 1, 0)
    fx, fy, cx, cy, width, height = np.moveaxis(_lenses(images.cameras), 1, 0)
    depth = np.where(z > NEAREST_M, z, np.inf)
    u, v = np.rint(fx * x / depth + cx), np.rint(fy * y / depth + cy)
    inside = (z > NEAREST_M) & (u >= 0) & (u < width) & (v >= 0) & (v < height)
    away = np.linalg.norm(in_cameras, axis=1)
    seen = np.zeros(z.shape, dtype=np.bool_)
    for row in np.flatnonzero(inside.any(axis=1)):
        camera, here = images.cameras[row], inside[row]
        if camera.name not in images.least_m:
            continue
        far = (z if camera.depth_kind == "planar" else away)[row, here, None]
        # of the two beside a speck one at most is a speck as well
        beside = (-1, 0, 1) if camera.flying_pixels else (0,)
        line = v[row, here, None].astype(np.intp)
        column = np.clip(u[row, here, None].astype(np.intp) + beside, 0, camera.width - 1)
        beyond = images.least_m[camera.name][line, column] > far
        if camera.name in model_depth:
            beyond |= np.abs(model_depth[camera.name][line, column]) > far
        seen[row, here] = beyond.any(axis=1)
    return seen


def _may_be_seen_grown(
    images: RoomImages,
    model_depth: Mapping[str, Image],
    in_cameras: NDArray[np.float64],
    maybe: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """As `_may_be_seen`, asked of some points of the ball about each part's centre as well."""
    far = np.array([images.aged_m.get(camera.name, 0.0) for camera in images.cameras])[:, None, None]
    for way in RIM:
        if not maybe.any(axis=0).all():
            break
        maybe = maybe & _may_be_seen(images, model_depth, in_cameras + far * way[:, None])
    return maybe


def _parts_seen(
    layout: Layout,
    row: int,
    bounds_m: tuple[Image, Image],
    model_m: Image | None,
    parts: _Parts,
) -> NDArray[np.bool_]:
    """Which parts one camera sees through, shape (parts,).

    Args:
        layout, row: cameras in the grid, and which of them.
        bounds_m: its images of least and greatest depth [m].
        model_m: what the machine explains of them [m]; None: nothing.
        parts: before it.
    """
    camera, record, corners = layout.cameras[row], layout.records[row], parts.corners
    nearest = corners[2].min() - parts.aged_m
    if nearest <= NEAREST_M:
        return np.zeros(len(STEPS), dtype=np.bool_)
    # as far as the growth reaches in the image, wherever in it the voxel is
    grown_px = (
        parts.aged_m
        / nearest
        * max(camera.intrinsics.fx, camera.intrinsics.fy)
        / float(record["least_cosine"])
    )
    window = _window(camera, float(record["lateral_px"]) + SPARE_PX + grown_px, corners)
    part = cut_out(record, *window)
    part["aged_m"] = parts.aged_m
    least_m, greatest_m = (np.ascontiguousarray(image[window]) for image in bounds_m)
    model = None if model_m is None else np.ascontiguousarray(model_m[window])
    trust, doubt = (np.empty(least_m.shape, dtype=np.uint32) for _ in range(2))
    texels_of(camera, layout.counting[row], (least_m, greatest_m), model, (trust, doubt))
    if camera.mask is not None:
        put_mask(camera.mask[window], (trust, doubt))
    texels = Texels(trust.reshape(-1), doubt.reshape(-1), _tiles(trust), _tiles(doubt), NO_TEXELS)
    x, y, z = parts.first.tolist()
    boxes, scratch = Boxes(x, y, z, parts.edge, 0), np.empty(1, VOXEL)[0]
    through = np.uint64(settle_word(part, texels, ALL, boxes, scratch)[0])
    if parts.aged_m > 0:
        through = np.uint64(still_through(part, texels, through, boxes, scratch))
    return np.unpackbits(np.array([through]).view(np.uint8), bitorder="little").view(np.bool_)


def _window(
    camera: DepthCamera, beyond_px: float, corners_in_camera: NDArray[np.float64]
) -> tuple[slice, slice]:
    """Rows and columns of an image with all pixels that meet a voxel before the camera, and spare ones."""
    k = camera.intrinsics
    x, y, z = corners_in_camera
    return (
        _span(k.fy * y / z + k.cy, beyond_px, camera.height),
        _span(k.fx * x / z + k.cx, beyond_px, camera.width),
    )


def _span(at: NDArray[np.float64], beyond: float, size: int) -> slice:
    """The pixels about some places along one side of an image."""
    first, last = int(np.floor(at.min() - beyond)), int(np.ceil(at.max() + beyond))
    return slice(max(first, 0), min(last, size - 1) + 1)


def _tiles(texels: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """The least of 4 x 4 texels each, in one row."""
    rows, columns = texels.shape
    tiles = np.empty((-(-rows // 4), -(-columns // 4)), dtype=np.uint32)
    pyramid.fill_tiles(texels, (0, rows, 0, columns), tiles)
    return tiles.reshape(-1)
