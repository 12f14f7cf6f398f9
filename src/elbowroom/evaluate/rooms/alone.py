"""The machine alone in the room: nothing is in its way, so every verdict must be clear."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from elbowroom.choices import Detail
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.rooms.room import cameras_row
from elbowroom.evaluate.rooms.scene import WELL_KNOWN, only, room_grid, room_motions, settings_of
from elbowroom.motion import Level, check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, render, wall_cameras

SAID = ("joint", "direction", "level", "band", "cause", "free_travel", "free_travel_unit")
"""What is kept of a verdict."""
DUE = (Due("clear_pct", "≥", 100.0, words="all clear"),)


def alone_rows(
    voxel_sizes_m: Sequence[float] = (0.02, 0.05),
    *,
    poses: int = 20,
    cameras: int = 21,
    size: str = "vga",
    heights_m: Sequence[float] = (2.4, 0.4),
    detail: Detail = "pixel",
    seed: int = 1,
) -> Iterator[dict[str, object]]:
    """Verdicts of all joints and directions between bare walls, floor and ceiling, with sensor noise.

    Args:
        voxel_sizes_m: each pose is judged with each of them, from the same images.
        poses: how many, drawn at random such that the reach of all joints stays inside the grid.
        cameras, size, heights_m: along the walls, at these heights in turn [m]. From 2.4 m alone no camera sees what
            lies under the machine's own overhangs.
        detail: of the carve.
        seed: of the poses.

    Yields:
        A row of kind "verdict" for each pose, voxel size and motion.
    """
    room = InterventionRoom(people=False, furniture=False)
    motions = room_motions(room.machine)
    views = wall_cameras(cameras, heights_m, size=size, noise=NOISE_PRESETS["tof"])
    rng = np.random.default_rng(seed)
    said = {"detail": detail, "seed": seed, **cameras_row(views), "heights_m": list(heights_m)}
    for pose in range(poses):
        moment = room.random_moment(rng)
        frames, joints = render(views, moment), moment.joints
        for edge in voxel_sizes_m:
            grid = room_grid(edge)
            space = reconstruct(
                grid, views, frames, room.machine, joints, detail=detail, margin=WELL_KNOWN, looks=False
            )
            for verdict in check_motions(space, room.machine, joints, motions):
                row = {"kind": "verdict", "pose": pose, "voxel_size_m": edge, **said}
                yield row | only(verdict.row(), SAID)


def alone_summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row of kind "summary" for each voxel size in rows of `alone_rows`: its verdicts by level."""
    summary = []
    for edge in dict.fromkeys(row["voxel_size_m"] for row in rows):
        of_edge = [row for row in rows if row["voxel_size_m"] == edge]
        levels = [row["level"] for row in of_edge]
        summary.append(
            {
                **settings_of(of_edge),
                "poses": len({row["pose"] for row in rows}),
                "verdicts": len(levels),
                **{level.name.lower(): levels.count(level.name.lower()) for level in Level},
                "clear_pct": 100 * levels.count("clear") / len(levels),
            }
        )
    return summary
