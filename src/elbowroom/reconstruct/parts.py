"""One voxel looked at again, in parts: what no one camera sees all of, several may see between them."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.reconstruct.free_space import FreeSpace, Source
from elbowroom.reconstruct.images import Image
from elbowroom.reconstruct.kernels import pyramid as pyramid
from elbowroom.reconstruct.kernels.box import ALL
from elbowroom.reconstruct.kernels.camera import Texels
from elbowroom.reconstruct.kernels.pixel import VOXEL, settle_word
from elbowroom.reconstruct.kernels.place import Boxes
from elbowroom.reconstruct.layout import layout_of
from elbowroom.reconstruct.records import counting_of, cut_out
from elbowroom.reconstruct.views import NO_TEXELS, texels_of

PARTS = 4
"""Along each axis a voxel is cut into so many parts: 64 in all, the bits of one word."""
SPARE_PX = 6
"""Of an image, so many pixels around those that meet the voxel are cut out as well: more than filters reach."""
NEAREST_M = 1e-3
"""A camera whose plane comes as near to the voxel as this is not asked [m]."""
STEPS = np.stack(np.meshgrid(*[range(PARTS)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
"""From the first part to each, in parts, in the order of bits."""
CORNERS = np.flatnonzero((STEPS % (PARTS - 1) == 0).all(axis=1))
"""The parts in the corners of the voxel."""


def is_free_in_parts(space: FreeSpace, index: tuple[int, int, int]) -> bool:
    """Whether each of 64 parts of a voxel is seen through by some camera, where nobody disputes the voxel.

    A part is seen through by the pixel test, as a voxel is. Who disputes a part disputes the voxel: so each part is
    free by the rule `three`. An object that touches the voxel touches a part of it, so this frees nothing that smaller
    voxels would not. Less evidence leaves fewer parts free, never more.

    Args:
        space: of detail `pixel` and rule `three`, with the frames it was made of (`FreeSpace.source`) and no less free
            than they say; else the answer is no.
        index: of the voxel, (i, j, k); one that cameras were not asked of, or that anybody disputes, is not free.
    """
    source = space.source
    if source is None or source.detail != "pixel" or source.rule != "three":
        return False
    if not _is_undisputed(space, source, index) or _more_is_blocked(space, source):
        return False
    edge = space.grid.voxel_size_m / PARTS
    first = space.grid.lower_m + np.array(index) * space.grid.voxel_size_m + edge / 2
    in_cameras = _in_cameras(source.images.cameras, first + STEPS * edge)
    maybe = _may_be_seen(source, in_cameras)
    # first the camera that may see most
    rows = np.argsort(-maybe.sum(axis=1), kind="stable")
    seen = np.zeros(len(STEPS), dtype=np.bool_)
    for position, row in enumerate(rows):
        if not (seen | maybe[rows[position:]].any(axis=0)).all():
            return False
        seen |= _parts_seen(space.grid, source, row, first, edge, in_cameras[row])
        if seen.all():
            return True
    return False


def _is_undisputed(space: FreeSpace, source: Source, index: tuple[int, int, int]) -> bool:
    """Whether cameras were asked of a voxel, and nobody disputes it."""
    word, bit = bits.place_of(index, space.grid)
    asked = source.focus is None or source.focus[word]
    return bool(asked and not space.disputed_words[word] & bit)


def _more_is_blocked(space: FreeSpace, source: Source) -> bool:
    """Whether somebody blocked what the frames say is free, such as a zone to keep out of."""
    return source.free_words is None or bool((source.free_words & ~space.free_words).any())


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


def _may_be_seen(source: Source, in_cameras: NDArray[np.float64]) -> NDArray[np.bool_]:
    """By camera and part, whether the pixel at the part's centre may be free beyond it, shape (cameras, parts).

    A camera sees through no other part: a pixel is free no farther than it measured, than the machine's model in it,
    or, if it is a speck, than the pixels beside it.
    """
    images = source.images
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
        if camera.name in source.model_depth:
            beyond |= np.abs(source.model_depth[camera.name][line, column]) > far
        seen[row, here] = beyond.any(axis=1)
    return seen


def _parts_seen(
    grid: VoxelGrid,
    source: Source,
    row: int,
    first: NDArray[np.float64],
    edge: float,
    in_camera: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Which parts one camera sees through, shape (parts,).

    Args:
        grid, source: of the space.
        row: of the camera.
        first: centre of the first part, world frame [m].
        edge: of a part [m].
        in_camera: centres of all parts in its axes, shape (3, parts) [m].
    """
    camera = source.images.cameras[row]
    middle = in_camera.mean(axis=1, keepdims=True)
    corners = middle + (in_camera[:, CORNERS] - middle) * PARTS / (PARTS - 1)
    if corners[2].min() <= NEAREST_M:
        return np.zeros(len(STEPS), dtype=np.bool_)
    rows, columns = _window(camera, source, corners)
    record = layout_of(grid, source.images.cameras, source.margin).records[row]
    part = cut_out(record, rows, columns)

    def of(image: Image) -> Image:
        return np.ascontiguousarray(image[rows, columns])

    bounds_m = of(source.images.least_m[camera.name]), of(source.images.greatest_m[camera.name])
    model = source.model_depth.get(camera.name)
    trust = np.empty((rows.stop - rows.start, columns.stop - columns.start), dtype=np.uint32)
    doubt = np.empty_like(trust)
    model_m = None if model is None else of(model)
    texels_of(camera, counting_of(camera, part), bounds_m, model_m, (trust, doubt))
    texels = Texels(trust.reshape(-1), doubt.reshape(-1), _tiles(trust), _tiles(doubt), NO_TEXELS)
    x, y, z = first.tolist()
    words = settle_word(part, texels, ALL, Boxes(x, y, z, edge, 0), np.empty(1, VOXEL)[0])
    return np.unpackbits(np.array(words[:1]).view(np.uint8), bitorder="little").view(np.bool_)


def _window(
    camera: DepthCamera, source: Source, corners_in_camera: NDArray[np.float64]
) -> tuple[slice, slice]:
    """Rows and columns of an image with all pixels that meet a voxel before the camera, and spare ones."""
    k = camera.intrinsics
    x, y, z = corners_in_camera
    beyond = (camera.margin or source.margin).lateral_px + SPARE_PX
    return _span(k.fy * y / z + k.cy, beyond, camera.height), _span(k.fx * x / z + k.cx, beyond, camera.width)


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
