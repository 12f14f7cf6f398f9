"""How much memory a room takes, estimated before anything is allocated."""

import os
from collections.abc import Sequence
from dataclasses import dataclass

from elbowroom.errors import GridError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.bits import word_count

PLANES = 12
"""Planes alive at once: one, two, three, disputed, surface, blind, unexplained, free, two of the body, and
two that are being computed."""
SHARED_BYTES = 250_000_000
"""Python, NumPy, Numba and their compiled kernels."""


@dataclass(frozen=True, slots=True)
class Memory:
    """Bytes that a room takes.

    Args:
        plane_bytes: one plane of the grid, at one bit a voxel in whole cubes of 16 voxels.
        planes_bytes: all planes that are alive at once.
        frames_bytes: newest frame of each camera, as float32.
        pyramids_bytes: least and greatest depth per texel in one 32-bit word, all levels.
        maps_bytes: index maps of distorted cameras and their rectified images.
    """

    plane_bytes: int
    planes_bytes: int
    frames_bytes: int
    pyramids_bytes: int
    maps_bytes: int

    @property
    def total_bytes(self) -> int:
        """All of it, with the interpreter and its libraries."""
        return SHARED_BYTES + self.planes_bytes + self.frames_bytes + self.pyramids_bytes + self.maps_bytes

    def row(self) -> dict[str, int]:
        """Part by part, and all of it."""
        return {
            "plane_bytes": self.plane_bytes,
            "planes_bytes": self.planes_bytes,
            "frames_bytes": self.frames_bytes,
            "pyramids_bytes": self.pyramids_bytes,
            "maps_bytes": self.maps_bytes,
            "memory_bytes": self.total_bytes,
        }


def memory_of(grid: VoxelGrid, cameras: Sequence[DepthCamera]) -> Memory:
    """What a grid and these cameras take."""
    plane = word_count(grid) * 8
    pixels = sum(camera.width * camera.height for camera in cameras)
    distorted = sum(camera.width * camera.height for camera in cameras if camera.intrinsics.is_distorted)
    return Memory(plane, PLANES * plane, 4 * pixels, 4 * pixels * 4 // 3, (8 + 8) * distorted)


def physical_memory_bytes() -> int | None:
    """Memory of this computer; None where it does not say."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def require_memory(grid: VoxelGrid, available_bytes: int | None) -> None:
    """Refuses a grid whose planes do not fit.

    Args:
        grid: the watched box.
        available_bytes: memory of this computer; None: unknown, nothing is refused.

    Raises:
        GridError: its planes take more.
    """
    needed = PLANES * word_count(grid) * 8
    if available_bytes is not None and needed > available_bytes:
        raise GridError(
            f"grid: {' x '.join(map(str, grid.shape))} voxels take {needed / 1e9:.1f} GB, this computer has "
            f"{available_bytes / 1e9:.1f} GB; choose larger voxels or a smaller box"
        )
