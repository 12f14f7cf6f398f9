"""How well cameras as they are placed see an empty room: views of each voxel, and whether they are enough."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.parallel import spread
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.kernels import views as kernels
from elbowroom.placement.requirement import TIE_RAD, Requirement
from elbowroom.placement.sight import sights


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """What each camera sees of a room with nothing in it but what is fixed.

    Args:
        grid: the watched box.
        cameras: in the order of `seen`.
        requirement: what a point must have to be valid.
        seen: bool, shape (cameras, *grid.shape): the camera sees the voxel's centre.
        counts: uint8, shape of the grid: number of cameras that see the voxel.
        apart: uint8, shape of the grid: size of the largest set of these that are pairwise the angle apart.
        asked: bool, shape of the grid: nothing fixed touches the voxel, so the requirement is asked of it.
    """

    grid: VoxelGrid
    cameras: tuple[DepthCamera, ...]
    requirement: Requirement
    seen: NDArray[np.bool_]
    counts: NDArray[np.uint8]
    apart: NDArray[np.uint8]
    asked: NDArray[np.bool_]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Voxels that are asked and meet the requirement, shape of the grid."""
        return (self.apart >= self.requirement.views) & self.asked

    @property
    def valid_pct(self) -> float:
        """Share of the voxels asked that meet the requirement [%]."""
        return 100.0 * float(self.valid.sum()) / float(self.asked.sum())

    def seen_pct(self, views: int) -> float:
        """Share of the voxels asked that at least so many cameras see, however far apart [%]."""
        return 100.0 * float(((self.counts >= views) & self.asked).sum()) / float(self.asked.sum())

    def row(self) -> dict[str, Any]:
        """A row of kind "verify": what was asked, and shares of the points [%]."""
        return {
            "kind": "verify",
            "cameras": len(self.cameras),
            "voxel_size_m": self.grid.voxel_size_m,
            "points": int(self.asked.sum()),
            "views": self.requirement.views,
            "angle_deg": self.requirement.angle_deg,
            "valid_pct": self.valid_pct,
            "seen_by_one_pct": self.seen_pct(1),
            "seen_by_views_pct": self.seen_pct(self.requirement.views),
            "mean_views": float(self.counts[self.asked].mean()),
        }


def verify(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    room: FixedRoom | None = None,
    requirement: Requirement | None = None,
) -> Verification:
    """Counts the views of every voxel and how many are pairwise far enough apart (thesis 3.3).

    Args:
        grid: the watched box.
        cameras: at most 255.
        room: walls and furniture; None: not known, so nothing blocks sight and every pixel has a return.
        requirement: None: three views, 100 degrees apart.

    Raises:
        InputError: no camera, more than 255, or no voxel that is not inside something fixed.
        CameraError: a camera inside a solid of the room.
    """
    asked = np.ones(grid.shape, dtype=bool) if room is None else ~room.occupied(grid)
    if not asked.any():
        raise InputError("placement: the watched box lies wholly inside walls or furniture; correct the room")
    seen = sights(grid, cameras, room)
    return judge(grid, cameras, seen, asked, requirement or Requirement())


def judge(
    grid: VoxelGrid,
    cameras: Sequence[DepthCamera],
    seen: NDArray[np.bool_],
    asked: NDArray[np.bool_],
    requirement: Requirement,
) -> Verification:
    """The verification of sights that are known already.

    Args:
        grid: the watched box.
        cameras: 1 to 255.
        seen: bool, shape (cameras, *grid.shape): the camera sees the voxel's centre; read-only from here on.
        asked: bool, shape of the grid: the requirement is asked of the voxel; read-only from here on.
        requirement: what a point must have to be valid.

    Raises:
        InputError: no camera, or more than 255.
    """
    if not 1 <= len(cameras) <= 255:
        raise InputError(f"placement: {len(cameras)} cameras, 1 to 255 can be verified")
    counts, apart = (np.zeros(grid.shape, dtype=np.uint8) for _ in range(2))
    eyes = np.array([camera.centre_in_world for camera in cameras])
    angle = math.radians(requirement.angle_deg)
    x, y = (
        grid.centre_of(np.arange(n)[:, None] * np.eye(3)[axis])[:, axis]
        for axis, n in ((0, grid.shape[0]), (1, grid.shape[1]))
    )
    spread(
        lambda i: kernels.count_views(seen[:, i], eyes, x[i], y, angle, TIE_RAD, counts[i], apart[i]),
        range(grid.shape[0]),
    )
    for array in (seen, counts, apart, asked):
        array.setflags(write=False)
    return Verification(grid, tuple(cameras), requirement, seen, counts, apart, asked)
