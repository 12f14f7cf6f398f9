"""What of a carve does not depend on the frames: cameras in a grid, and memory for their images."""

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.margin import Margin
from elbowroom.reconstruct.kernels.camera import Texels
from elbowroom.reconstruct.kernels.pyramid import TILE_LEVEL
from elbowroom.reconstruct.kernels.texels import Counting
from elbowroom.reconstruct.records import Records, counting_of, records_of

SQUARES = 4
"""Of tiles, squares of 1, 2, 4 and 8 either way are kept."""


@dataclass(slots=True, eq=False)
class Buffers:
    """Memory that one carve fills and the next one fills again: fresh pages would cost more than the filling.

    Texels and tiles of doubt are those of trust where no camera doubts more than it trusts.
    """

    texels: Texels
    windows: NDArray[np.uint32]

    @property
    def split(self) -> bool:
        """Whether doubt is kept apart from trust."""
        return self.texels.doubt_texels is not self.texels.trust_texels


@dataclass(slots=True, eq=False)
class Layout:
    """What of a carve does not depend on the frames: cameras in a grid.

    Args:
        grid, cameras: what was laid out.
        records: of the cameras, as kernels take them; what is of the moment is zero.
        counting: how each camera counts depth; reading it from a record costs as much as a small kernel.
        texels, tiles: by camera, where its own are in arrays of all.
        windows: how many texels of windows all cameras have.
        inside: the voxels of the grid.
    """

    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    records: Records
    counting: tuple[Counting, ...]
    texels: tuple[slice, ...]
    tiles: tuple[slice, ...]
    windows: int
    inside: Words
    _spare: list[Buffers] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def take_buffers(self, split: bool) -> Buffers:
        """Buffers of the last carve, or new ones; `split`: with doubt apart from trust."""
        with self._lock:
            for position, buffers in enumerate(self._spare):
                if buffers.split == split:
                    return self._spare.pop(position)
        trust, tiles = (
            np.zeros(own[-1].stop if own else 0, dtype=np.uint32) for own in (self.texels, self.tiles)
        )
        doubt, doubt_tiles = (np.zeros_like(a) if split else a for a in (trust, tiles))
        trust_squares, squares = (
            np.zeros((many, len(tiles)), dtype=np.uint32) for many in (SQUARES, SQUARES if split else 0)
        )
        return Buffers(
            Texels(trust, doubt, tiles, doubt_tiles, trust_squares, squares),
            np.zeros(self.windows, dtype=np.uint32),
        )

    def give_back(self, buffers: Buffers) -> None:
        """Returns buffers for the next carve."""
        with self._lock:
            del self._spare[1:]
            self._spare.insert(0, buffers)


@lru_cache(maxsize=16)
def layout_of(grid: VoxelGrid, cameras: tuple[DepthCamera, ...], margin: Margin) -> Layout:
    """Lays cameras out over a grid. Distorted cameras must have been made pinhole before.

    Args:
        grid: the watched box.
        cameras: pinhole.
        margin: of cameras without one of their own.

    Raises:
        CameraError: a camera is still distorted, or more than 255 cameras.
    """
    if len(cameras) > 255:
        raise CameraError(f"carve: {len(cameras)} cameras in one group, at most 255 can be counted")
    for camera in cameras:
        if camera.intrinsics.is_distorted:
            raise CameraError(
                f"camera {camera.name}: is distorted, bring its image to a pinhole image before carving"
            )
    records = records_of(grid, cameras, margin)
    levels = max((_levels_of(camera) for camera in cameras), default=1)
    shapes = [_shapes_of(camera, levels) for camera in cameras]
    windows = _put_levels(records, shapes)
    texels = _one_after_the_other([sizes[0] for sizes in shapes])
    tiles = _one_after_the_other([sizes[TILE_LEVEL] for sizes in shapes])
    records["first_texel"] = [own.start for own in texels]
    records["first_tile"] = [own.start for own in tiles]
    counting = tuple(map(counting_of, cameras, records))
    return Layout(grid, cameras, records, counting, texels, tiles, windows, bits.inside(grid))


def _put_levels(records: Records, shapes: Sequence[Sequence[tuple[int, int]]]) -> int:
    """Where each level of windows begins, of cameras with images of these shapes by level; how many texels in all."""
    first = 0
    for n, sizes in enumerate(shapes):
        lowest = min(int(records["lowest"][n]), len(sizes) - 1)
        records["levels"][n], records["lowest"][n] = len(sizes), lowest
        for level, (height, width) in enumerate(sizes):
            records["level_first"][n, level], records["level_stride"][n, level] = first, width
            first += height * width if level >= lowest else 0
    return first


def _levels_of(camera: DepthCamera) -> int:
    """So many that the last is one texel, and that there are tiles."""
    return max(int(np.ceil(np.log2(max(camera.width, camera.height)))), TILE_LEVEL) + 1


def _shapes_of(camera: DepthCamera, levels: int) -> list[tuple[int, int]]:
    """Rows and columns of each level."""
    shapes = [(camera.height, camera.width)]
    for _ in range(levels - 1):
        height, width = shapes[-1]
        shapes.append((-(-height // 2), -(-width // 2)))
    return shapes


def _one_after_the_other(shapes: Sequence[tuple[int, int]]) -> tuple[slice, ...]:
    """Slices of one array for images of these shapes."""
    ends = np.cumsum([0, *(height * width for height, width in shapes)]).tolist()
    return tuple(slice(start, stop) for start, stop in pairwise(ends))
