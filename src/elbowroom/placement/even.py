"""Cameras spread evenly along the walls, as the thesis places them, and the curve of its Fig. 4."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import DepthCamera, VoxelGrid, looking_at
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.requirement import Requirement
from elbowroom.placement.sensor import Sensor
from elbowroom.placement.verification import Verification, verify

FROM_WALL_M = 0.01
"""Cameras hang so far before the wall's inner face [m]."""
AIMS_M = (0.2, 0.4, 0.6, 0.8, 1.0, 1.2)
"""Heights of the middle axis among which the aim is chosen [m]."""
AIMED_WITH = 21


def even_cameras(
    walls_m: NDArray[np.float64],
    sensor: Sensor,
    count: int,
    *,
    heights_m: Sequence[float] = (2.4,),
    aim_m: float = 1.0,
) -> tuple[DepthCamera, ...]:
    """Cameras at equal distances along four walls, each looking at the room's vertical middle axis.

    The first hangs in the middle of the wall at +x, the others follow counter-clockwise seen from above.

    Args:
        walls_m: inner faces, least and greatest corner, shape (2, 3), world frame [m].
        sensor: their kind.
        count: how many.
        heights_m: above z = 0; neighbours take them in turn [m].
        aim_m: height at which the optical axis meets the middle axis [m].

    Returns:
        Cameras "cam00", "cam01" and so on.

    Raises:
        InputError: fewer than one camera, or no height.
    """
    if count != int(count) or count < 1:
        raise InputError(f"placement: {count} cameras, must be a whole number of at least 1")
    if not len(heights_m):
        raise InputError("placement: no height, at least one is needed")
    middle = walls_m[:, :2].mean(axis=0)
    half = (walls_m[1, :2] - walls_m[0, :2]) / 2 - FROM_WALL_M
    digits = max(2, len(str(count - 1)))
    cameras = []
    for number in range(count):
        x, y = middle + _along(number / count, half)
        eye = (float(x), float(y), float(heights_m[number % len(heights_m)]))
        pose = looking_at(eye, (float(middle[0]), float(middle[1]), aim_m))
        cameras.append(sensor.at(f"cam{number:0{digits}d}", pose))
    return tuple(cameras)


def _along(share: float, half: NDArray[np.float64]) -> NDArray[np.float64]:
    """The place at a share of the way round a rectangle about the origin, from the middle of its side at +x."""
    a, b = half
    way = (share * 4 * (a + b) + b) % (4 * (a + b))
    corners = [(a, -b), (a, b), (-a, b), (-a, -b)]
    for side, length in enumerate((2 * b, 2 * a, 2 * b, 2 * a)):
        if way <= length:
            start, end = np.array(corners[side]), np.array(corners[(side + 1) % 4])
            return start + (end - start) * (way / length)
        way -= length
    return np.array(corners[0])


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """How valid an empty room is by the number of evenly spread cameras (thesis Fig. 4).

    Args:
        counts: numbers of cameras.
        valid_pct: share of valid points with each [%].
        seen_pct: share of points seen by so many cameras as are required, however far apart [%].
        aim_m: where the cameras look [m].
        seconds: what each took.
    """

    counts: tuple[int, ...]
    valid_pct: tuple[float, ...]
    seen_pct: tuple[float, ...]
    aim_m: float
    seconds: tuple[float, ...]

    def least(self, share_pct: float) -> int | None:
        """The smallest number of cameras with at least this share of valid points [%]; None: there is none."""
        return next(
            (n for n, valid in zip(self.counts, self.valid_pct, strict=True) if valid >= share_pct), None
        )

    def rows(self) -> list[dict[str, Any]]:
        """A row of kind "layout" for each number of cameras: shares [%], and where they look."""
        return [
            {
                "kind": "layout",
                "cameras": count,
                "valid_pct": valid,
                "seen_by_views_pct": seen,
                "aim_m": self.aim_m,
            }
            for count, valid, seen in zip(self.counts, self.valid_pct, self.seen_pct, strict=True)
        ]

    def row(self, share_pct: float) -> dict[str, Any]:
        """A row of kind "sweep": the least number of cameras with a share of valid points, and the best share [%]."""
        return {
            "kind": "sweep",
            "share_pct": share_pct,
            "least_cameras": self.least(share_pct),
            "layouts": len(self.counts),
            "best_valid_pct": max(self.valid_pct),
        }


def even_verification(
    grid: VoxelGrid,
    room: FixedRoom,
    sensor: Sensor,
    count: int,
    requirement: Requirement,
    heights_m: Sequence[float],
    aim_m: float,
) -> Verification:
    """The verification of evenly spread cameras.

    Args:
        grid: the watched box.
        room: with walls.
        sensor, count: kind and number of the cameras.
        requirement: what a point must have to be valid.
        heights_m, aim_m: of the cameras, and where they look; as of `even_cameras` [m].

    Raises:
        InputError: the room has no walls along which cameras could be spread.
    """
    if room.walls_m is None:
        raise InputError("placement: no walls to spread cameras along; give room.walls in the site file")
    cameras = even_cameras(room.walls_m, sensor, count, heights_m=heights_m, aim_m=aim_m)
    return verify(grid, cameras, room, requirement)


def best_aim(
    grid: VoxelGrid,
    room: FixedRoom,
    sensor: Sensor,
    requirement: Requirement,
    heights_m: Sequence[float] = (2.4,),
    *,
    count: int = AIMED_WITH,
    aims_m: Sequence[float] = AIMS_M,
) -> float:
    """Of some aims the one with which evenly spread cameras leave most points valid; the lowest of equals [m].

    Args:
        grid: the watched box.
        room: with walls.
        sensor, count: kind and number of the cameras.
        requirement: what a point must have to be valid.
        heights_m: of the cameras; neighbours take them in turn [m].
        aims_m: heights of the middle axis to choose from, ascending [m].

    Raises:
        InputError: a room without walls.
    """
    shares = [
        even_verification(grid, room, sensor, count, requirement, heights_m, aim).valid_pct for aim in aims_m
    ]
    return float(aims_m[int(np.argmax(shares))])


def sweep(
    grid: VoxelGrid,
    room: FixedRoom,
    sensor: Sensor,
    counts: Sequence[int],
    requirement: Requirement | None = None,
    *,
    heights_m: Sequence[float] = (2.4,),
    aim_m: float | None = None,
    progress: Progress = silent,
) -> Sweep:
    """The share of valid points over the number of evenly spread cameras.

    Args:
        grid: the watched box.
        room: with walls.
        sensor: kind of the cameras.
        counts: numbers of cameras, ascending.
        requirement: None: three views, 100 degrees apart.
        heights_m: of the cameras [m].
        aim_m: where they look [m]; None: the best of `AIMS_M` with 21 cameras.
        progress: called with what is being done.

    Raises:
        InputError: no counts, or a room without walls.
    """
    if not counts:
        raise InputError("placement: no numbers of cameras; give a range such as 3 to 40")
    wanted = requirement or Requirement()
    if aim_m is None:
        progress("choosing where the cameras look")
        aim_m = best_aim(grid, room, sensor, wanted, heights_m)
    rows = list(_rows(grid, room, sensor, counts, wanted, heights_m, aim_m, progress))
    valid, seen, seconds = zip(*rows, strict=True)
    return Sweep(tuple(counts), valid, seen, aim_m, seconds)


def _rows(
    grid: VoxelGrid,
    room: FixedRoom,
    sensor: Sensor,
    counts: Sequence[int],
    requirement: Requirement,
    heights_m: Sequence[float],
    aim_m: float,
    progress: Progress,
) -> Iterator[tuple[float, float, float]]:
    for count in counts:
        progress(f"{count} cameras")
        begun = time.perf_counter()
        found = even_verification(grid, room, sensor, count, requirement, heights_m, aim_m)
        yield found.valid_pct, found.seen_pct(requirement.views), time.perf_counter() - begun
