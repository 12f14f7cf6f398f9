"""Cameras and frames as the arrays that carving kernels take."""

import threading
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.parallel import spread
from elbowroom.reconstruct.images import Image, RoomImages
from elbowroom.reconstruct.kernels import box as box
from elbowroom.reconstruct.kernels import pyramid as pyramid
from elbowroom.reconstruct.kernels.box import Views

TILE_LEVEL = 2
"""The level whose texels the pixel test passes over at once: 4 x 4 pixels."""
SQUARES = 3
"""Of tiles of doubt, squares of 2, 4 and 8 either way are kept."""
SPARE_M = 0.5
"""Depth beyond the grid's farthest corner that is still told apart."""
STEP = Margin(sigmas=3.0)
STEP_WITHOUT_NOISE = Margin(range_linear=0.005)
"""By how much depth must differ between neighbours to step, of cameras with a noise model and of others.

Were it the margin of the carve, a wider margin would lower fewer pixels and so could add free space.
"""

NO_IMAGE = np.zeros((0, 0), dtype=np.float32)
NO_TEXELS = np.zeros((0, 0), dtype=np.uint32)
Rectangle = tuple[int, int, int, int]
"""First row, one past the last, first column, one past the last."""
NOWHERE: Rectangle = (0, 0, 0, 0)


def margin_polynomial(camera: DepthCamera, margin: Margin) -> NDArray[np.float64]:
    """k sigma(z) + bias + range error as (constant, linear, quadratic, quadratic beyond offset, offset)."""
    constant, linear, beyond, offset = margin.bias_m, margin.range_linear, 0.0, 0.0
    if camera.noise is not None:
        constant += margin.sigmas * camera.noise.constant_m
        linear += margin.sigmas * camera.noise.linear
        beyond, offset = margin.sigmas * camera.noise.quadratic, camera.noise.offset_m
    return np.array([constant, linear, margin.range_quadratic, beyond, offset])


@dataclass(slots=True, eq=False)
class _Buffers:
    """Memory that one carve fills and the next one fills again: fresh pages would cost more than the filling.

    `doubt_texels` and `doubt_tiles` are those of trust where no camera doubts more than it trusts.
    """

    trust_texels: NDArray[np.uint32]
    doubt_texels: NDArray[np.uint32]
    trust_tiles: NDArray[np.uint32]
    doubt_tiles: NDArray[np.uint32]
    doubt_squares: NDArray[np.uint32]
    windows: NDArray[np.uint32]


@dataclass(slots=True, eq=False)
class Layout:
    """What of a carve does not depend on the frames: cameras in a grid."""

    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    numbers: NDArray[np.float64]
    levels: NDArray[np.int64]
    offset: NDArray[np.float32]
    texel_first: NDArray[np.int64]
    tile_first: NDArray[np.int64]
    shapes: list[list[tuple[int, int]]]
    inside: Words
    _spare: list[_Buffers] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def take_buffers(self, split: bool) -> _Buffers:
        """Buffers of the last carve, or new ones; `split`: with doubt apart from trust."""
        with self._lock:
            for position, buffers in enumerate(self._spare):
                if (buffers.doubt_texels is not buffers.trust_texels) == split:
                    return self._spare.pop(position)
        texels = int(self.texel_first[-1])
        windows = int(self.levels[-1, -1, 0] + 1) if self.cameras else 0
        trust = [np.zeros(size, dtype=np.uint32) for size in (texels, int(self.tile_first[-1]))]
        doubt = [np.zeros_like(array) for array in trust] if split else trust
        squares = np.zeros((SQUARES if split else 0, len(trust[1])), dtype=np.uint32)
        return _Buffers(trust[0], doubt[0], trust[1], doubt[1], squares, np.zeros(windows, dtype=np.uint32))

    def give_back(self, buffers: _Buffers) -> None:
        """Returns buffers for the next carve."""
        with self._lock:
            del self._spare[1:]
            self._spare.insert(0, buffers)


@lru_cache(maxsize=8)
def layout_of(grid: VoxelGrid, cameras: tuple[DepthCamera, ...], margin: Margin) -> Layout:
    """Lays cameras out over a grid. Distorted cameras must have been made pinhole before.

    Raises:
        CameraError: a camera is still distorted, or more than 255 cameras.
    """
    if len(cameras) > 255:
        raise CameraError(f"carve: {len(cameras)} cameras in one group, at most 255 can be counted")
    numbers = np.zeros((len(cameras), box.COLUMNS))
    offset = np.zeros((len(cameras), 2, 3, 64), dtype=np.float32)
    lanes = np.stack(np.meshgrid(range(4), range(4), range(4), indexing="ij"), axis=-1).reshape(64, 3)
    corners = grid.lower_m + (grid.upper_m - grid.lower_m) * np.stack(
        np.meshgrid((0, 1), (0, 1), (0, 1), indexing="ij"), axis=-1
    ).reshape(8, 3)
    depth = max((_levels_of(camera) for camera in cameras), default=1)
    levels = np.zeros((len(cameras), depth, 2), dtype=np.int64)
    texel_first = np.zeros(len(cameras) + 1, dtype=np.int64)
    tile_first = np.zeros(len(cameras) + 1, dtype=np.int64)
    shapes, first = [], 0
    for c, camera in enumerate(cameras):
        if camera.intrinsics.is_distorted:
            raise CameraError(
                f"camera {camera.name}: is distorted, bring its image to a pinhole image before carving"
            )
        own = camera.margin or margin
        k = camera.intrinsics
        rotation = camera.camera_from_world[:3, :3]
        polynomial = margin_polynomial(camera, own)
        reach = float(np.linalg.norm(corners - camera.centre_in_world, axis=1).max()) + SPARE_M
        reach += float(pyramid.margin_at.py_func(reach, polynomial))
        pitch = _pitch_of(camera)
        if camera.flying_pixels and pitch < 1.0:
            # the farthest that is told apart, less the pitch that specks are short of it, lies beyond the grid as well
            reach /= 1.0 - pitch
        row = numbers[c]
        row[:12] = camera.camera_from_world[:3].reshape(12)
        row[box.LENS : box.LENS + 4] = k.fx, k.fy, k.cx, k.cy
        row[box.SIZE : box.SIZE + 2] = camera.width, camera.height
        row[box.MARGIN : box.MARGIN + 5] = polynomial
        row[box.LATERAL] = own.lateral_px
        # a power of two: where a wider margin makes quanta coarser, no rounding becomes more favourable
        row[box.QUANTUM] = 2.0 ** np.ceil(np.log2(reach / (pyramid.FAR_CLIP - 4)))
        row[box.RADIAL] = camera.depth_kind == "radial"
        row[box.CENTRE : box.CENTRE + 3] = camera.centre_in_world
        along_u, along_v = rotation[0] / k.fx, rotation[1] / k.fy
        turn = row[box.TURN : box.TURN + 12].reshape(4, 3)
        turn[0] = rotation[2] - along_u * k.cx - along_v * k.cy
        turn[1:3] = along_u, along_v
        turn[3] = (np.abs(along_u) + np.abs(along_v)) * (0.5 + own.lateral_px)
        aside = max(k.cx + 0.5, camera.width - 0.5 - k.cx) / k.fx
        above = max(k.cy + 0.5, camera.height - 0.5 - k.cy) / k.fy
        row[box.COSINE] = 1.0 / np.sqrt(1.0 + aside**2 + above**2)
        middle = float(np.linalg.norm(grid.lower_m / 2 + grid.upper_m / 2 - camera.centre_in_world))
        # windows over single pixels only where voxels of the middle of the grid are that small
        row[box.LOWEST] = 0 if 0.5 * grid.voxel_size_m * k.fx < max(middle, 1e-3) else 1
        for scale, edge in enumerate((grid.voxel_size_m, 4 * grid.voxel_size_m)):
            shift = rotation @ lanes.T * edge
            offset[c, scale] = shift * np.array([k.fx, k.fy, 1.0])[:, None]
            half = row[box.HALF_EXTENT + 4 * scale : box.HALF_EXTENT + 4 * scale + 4]
            half[:3] = np.abs(rotation).sum(axis=1) * edge / 2
            half[3] = edge * 0.8660255
        own_shapes = [(camera.height, camera.width)]
        for _ in range(depth - 1):
            h, w = own_shapes[-1]
            own_shapes.append((-(-h // 2), -(-w // 2)))
        row[box.LOWEST] = min(row[box.LOWEST], depth - 1)
        for level, (h, w) in enumerate(own_shapes):
            levels[c, level] = first, w
            first += h * w if level >= row[box.LOWEST] else 0
        shapes.append(own_shapes)
        texel_first[c + 1] = texel_first[c] + camera.width * camera.height
        tile_first[c + 1] = tile_first[c] + own_shapes[TILE_LEVEL][0] * own_shapes[TILE_LEVEL][1]
    return Layout(grid, cameras, numbers, levels, offset, texel_first, tile_first, shapes, bits.inside(grid))


def _pitch_of(camera: DepthCamera) -> float:
    """Of a pixel, as a share of its depth."""
    return 1.0 / min(camera.intrinsics.fx, camera.intrinsics.fy)


def _levels_of(camera: DepthCamera) -> int:
    return max(int(np.ceil(np.log2(max(camera.width, camera.height)))), TILE_LEVEL) + 1


def fill(layout: Layout, images: RoomImages, model_depth: Mapping[str, Image]) -> tuple[Views, _Buffers]:
    """Builds the windows of all cameras; a camera without images is blank.

    Args:
        layout: cameras in a grid.
        images: of those cameras.
        model_depth: by camera, depth up to which the machine explains the pixel [m], 0 where it does not.

    Returns:
        What kernels take, and the buffers behind it, to be given back after the carve.
    """
    split = bool(model_depth) or any(camera.flying_pixels for camera in layout.cameras)
    buffers = layout.take_buffers(split)
    numbers = layout.numbers.copy()

    def build(c: int) -> None:
        camera = layout.cameras[c]
        here = slice(layout.texel_first[c], layout.texel_first[c + 1])
        shape = (camera.height, camera.width)
        trust = buffers.trust_texels[here].reshape(shape)
        doubt = buffers.doubt_texels[here].reshape(shape) if split else trust
        apart = NOWHERE
        if camera.name in images.least_m:
            least_m, greatest_m = images.least_m[camera.name], images.greatest_m[camera.name]
            model_m = model_depth.get(camera.name)
            explained, apart = texels_of(camera, numbers[c], least_m, greatest_m, model_m, trust, doubt)
            numbers[c, box.SPLIT] = explained
        else:
            numbers[c, box.BLANK] = 1
            trust[:] = 0
            doubt[:] = 0
        tiles = slice(layout.tile_first[c], layout.tile_first[c + 1])
        lowest = int(numbers[c, box.LOWEST])
        trust_tiles = buffers.trust_tiles[tiles]
        pyramid.fill_levels(trust, lowest, layout.levels[c, :, 0], TILE_LEVEL, trust_tiles, buffers.windows)
        if split:
            doubt_tiles = buffers.doubt_tiles[tiles].reshape(layout.shapes[c][TILE_LEVEL])
            doubt_tiles.reshape(-1)[:] = trust_tiles
            pyramid.fill_tiles(doubt, *apart, doubt_tiles)
            _squares(doubt_tiles, buffers.doubt_squares[:, tiles])

    spread(build, range(len(layout.cameras)))
    views = Views(
        numbers,
        layout.levels,
        layout.offset,
        buffers.windows,
        layout.texel_first,
        buffers.trust_texels,
        buffers.doubt_texels,
        layout.tile_first,
        buffers.trust_tiles,
        buffers.doubt_tiles,
        buffers.doubt_squares,
    )
    return views, buffers


def _squares(tiles: NDArray[np.uint32], squares: NDArray[np.uint32]) -> None:
    """Squares of one camera's tiles of doubt, shape (SQUARES, tiles)."""
    smaller = tiles
    for level in range(SQUARES):
        larger = squares[level].reshape(tiles.shape)
        pyramid.squares_of(smaller, 2 << level, larger)
        smaller = larger


def _read_only(image: Image) -> Image:
    """The same image, as frames have it: to numba one that may be written is another type, to be compiled anew."""
    view = image.view()
    view.setflags(write=False)
    return view


def texels_of(
    camera: DepthCamera,
    numbers: NDArray[np.float64],
    least_m: Image,
    greatest_m: Image,
    model_m: Image | None,
    trust: NDArray[np.uint32],
    doubt: NDArray[np.uint32],
) -> tuple[bool, Rectangle]:
    """Level 0 of one camera: what its pixels free, and what they measured.

    Args:
        camera: whose pixels.
        numbers: its row of `Views.numbers`.
        least_m, greatest_m: bounds of depth per pixel, all of the image or a part of it [m].
        model_m: up to where the machine explains each pixel [m], 0 where it does not; None: it explains nothing.
        trust, doubt: of the same shape, written; may be one array where nothing is explained and no pixels fly.

    Returns:
        Whether the machine explains any pixels, and a rectangle outside of which both are the same.
    """
    polynomial = numbers[box.MARGIN : box.MARGIN + 5]
    quantum = numbers[box.QUANTUM]
    low, high = np.float32(camera.min_depth_m), np.float32(camera.max_depth_m)
    model = NO_IMAGE if model_m is None else model_m
    least_m, greatest_m = _read_only(least_m), _read_only(greatest_m)
    # not one array by two names: the compiler could not tell, and would do one pixel at a time
    other = NO_TEXELS if doubt is trust else doubt
    apart = pyramid.texels_of_frame(
        least_m, greatest_m, low, high, np.float32(quantum), model, polynomial, trust, other
    )
    explained = apart[0] < apart[1]
    if camera.flying_pixels:
        if not explained:
            model = NO_IMAGE
        step = margin_polynomial(camera, STEP if camera.noise is not None else STEP_WITHOUT_NOISE)
        passed = np.empty_like(trust)
        pyramid.pass_over_specks(trust, _pitch_of(camera), model, polynomial, quantum, passed)
        pyramid.lower_at_steps(passed, doubt, quantum, step, trust)
        pyramid.mark_explained(model, polynomial, quantum, trust, doubt)
        apart = (0, trust.shape[0], 0, trust.shape[1])
    return explained, apart
