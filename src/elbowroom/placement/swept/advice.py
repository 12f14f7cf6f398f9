"""Where one more camera would see most of what nobody sees of a machine's swept space."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, looking_at
from elbowroom.machine import Machine
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.swept.unseen import Swept, scene_at, seen_at

FROM_WALL_M = 0.1
PLACES = 8
"""Round the room, at each height."""
HEIGHTS = (0.15, 0.5, 0.85)
"""Between floor and ceiling, as shares of the height between."""
MOST_POSES = 3
"""Places are tried with the machine in so many poses."""
LEAST_PCT = 1.0
"""Where less than this is unseen, no camera is missing."""
WIDTH, HEIGHT, FOCAL_PX = 160, 120, 80.0


class More(NamedTuple):
    """A place for one more camera, where it looks, and the share of what nobody sees that it would see [%]."""

    place_m: tuple[float, float, float]
    look_at_m: tuple[float, float, float]
    sees_pct: float

    @property
    def words(self) -> str:
        """As one line of advice."""
        (x, y, z), (a, b, c) = self.place_m, self.look_at_m
        return (
            f"a camera at x {x:.2f}, y {y:.2f}, z {z:.2f} m that looks at x {a:.2f}, y {b:.2f}, z {c:.2f} m would see "
            f"{self.sees_pct:.0f} % of what nobody sees"
        )


def one_more(found: Swept, machine: Machine, room: FixedRoom | None) -> More | None:
    """Of places round the room at three heights the one that sees most of it; None: hardly anything is unseen.

    The camera that is tried is 90 degrees wide.

    Args:
        found: what is swept, and what of it nobody sees.
        machine: what moves.
        room: walls and furniture; None: not known, then places are round the watched box.
    """
    some = found.by_pose[:MOST_POSES]
    total = sum(int(unseen.sum()) for _, unseen in some)
    if found.unseen_pct < LEAST_PCT or not total:
        return None
    middle = found.grid.centre_of(np.argwhere(found.unseen > 0)).mean(axis=0)
    scenes = [
        (found.grid.centre_of(np.argwhere(unseen)), scene_at(machine, joints, room))
        for joints, unseen in some
    ]
    best: tuple[int, DepthCamera] | None = None
    for camera in _tried(found.grid, room, middle):
        seen = sum(int(seen_at(points, [camera], scene, room is not None).sum()) for points, scene in scenes)
        if best is None or seen > best[0]:
            best = seen, camera
    if best is None or not best[0]:
        return None
    x, y, z = (float(v) for v in best[1].centre_in_world)
    a, b, c = (float(v) for v in middle)
    return More((x, y, z), (a, b, c), 100.0 * best[0] / total)


def _tried(grid: VoxelGrid, room: FixedRoom | None, look_at: NDArray[np.float64]) -> Iterator[DepthCamera]:
    """Cameras round the room that look at a place; none inside anything fixed."""
    known = room is not None and room.walls_m is not None
    lower, upper = (room.walls_m[0], room.walls_m[1]) if known else (grid.lower_m, grid.upper_m)  # type: ignore[union-attr,index]
    lower, upper = lower + FROM_WALL_M, upper - FROM_WALL_M
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    lens = Intrinsics(fx=FOCAL_PX, fy=FOCAL_PX, cx=(WIDTH - 1) / 2, cy=(HEIGHT - 1) / 2)
    for share in HEIGHTS:
        for angle in 2 * np.pi * np.arange(PLACES) / PLACES:
            way = np.array([np.cos(angle), np.sin(angle)])
            place = np.append(middle[:2] + half[:2] * way / np.abs(way).max(), lower[2] + share * 2 * half[2])
            if np.linalg.norm(place - look_at) < FROM_WALL_M:
                continue
            camera = DepthCamera("more", WIDTH, HEIGHT, looking_at(place.tolist(), look_at.tolist()), lens)
            try:
                if room is not None:
                    room.refuse_inside((camera,))
            except CameraError:
                continue
            yield camera
