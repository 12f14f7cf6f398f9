"""The whole room at random moments: verdicts from depth images beside those of exact geometry."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from elbowroom.choices import Detail
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.rooms.room import cameras_row
from elbowroom.evaluate.rooms.scene import WELL_KNOWN, Comparison, only, room_grid, room_motions, settings_of
from elbowroom.motion import Level, check_motions
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, render, wall_cameras
from elbowroom.simulate.inside import hung_clear

COMPARED = (
    *("joint", "direction", "level", "cause", "free_travel", "free_travel_unit"),
    *("true_level", "true_travel", "truly_clear", "milder"),
)
"""What is kept of a comparison; joints, places and solids follow from seed and number of the pose."""
DUE = (
    Due("milder", "≤", 0),
    Due("stop_where_clear_pct", "≤", 3.0, where(noise=False)),
    Due("stop_where_clear_pct", "≤", 8.0, where(noise=True)),
)


def poses_rows(
    voxel_size_m: float = 0.02,
    *,
    poses: int = 200,
    cameras: int = 21,
    size: str = "vga",
    heights_m: Sequence[float] = (2.4, 0.4),
    detail: Detail = "pixel",
    noise: bool = False,
    seed: int = 2,
) -> Iterator[dict[str, object]]:
    """Images of the room and its people; every motion judged from them and by exact geometry.

    Exact geometry: how far the checked links that move can go until their meshes touch a solid of the room.

    Args:
        voxel_size_m: edge of a voxel [m].
        poses: how many moments, each with the machine in a random pose that touches nothing.
        cameras, size, heights_m: along the walls, at these heights in turn [m]. From 2.4 m alone no camera sees what
            lies under the machine's own overhangs. Those that would hang inside a cabinet hang beside it.
        detail: of the carve.
        noise: whether cameras are of time of flight, with noise and flying pixels; else they are exact.
        seed: of moments and poses.

    Yields:
        A row of kind "verdict" for each moment and motion.

    Raises:
        PackageError: coal is not installed.
    """
    room = InterventionRoom()
    motions = room_motions(room.machine)
    noise_model = NOISE_PRESETS["tof"] if noise else None
    views = hung_clear(
        wall_cameras(cameras, heights_m, size=size, noise=noise_model), room.at(0.0).static_solids
    )
    grid = room_grid(voxel_size_m)
    rng = np.random.default_rng(seed)
    said = {
        "voxel_size_m": voxel_size_m,
        "detail": detail,
        "noise": noise,
        "seed": seed,
        **cameras_row(views),
    }
    for pose in range(poses):
        moment = room.random_moment(rng)
        truth, joints = ExactTravel(room.machine, moment.solids), moment.joints
        frames = render(views, moment, noise=noise)
        space = reconstruct(
            grid, views, frames, room.machine, joints, detail=detail, margin=WELL_KNOWN, looks=False
        )
        verdicts = check_motions(space, room.machine, joints, motions)
        for motion, verdict in zip(motions, verdicts, strict=True):
            compared = Comparison(motion, verdict, truth.until_contact(joints, motion)).row()
            row = {"kind": "verdict", "pose": pose, **said, "heights_m": list(heights_m)}
            yield row | only(compared, COMPARED)


def poses_summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The row of kind "summary" for rows of `poses_rows`.

    Its `milder` counts verdicts of a milder level or with more free travel than exact geometry's; its
    `stop_where_clear_pct` is a share of those motions whose way is truly clear over their whole reach.
    """
    clear = [row["level"] for row in rows if row["truly_clear"]]
    ranks = {level.name.lower(): level.rank for level in Level}
    return {
        **settings_of(rows),
        "noise": bool(rows and rows[0].get("noise")),
        "poses": len({row["pose"] for row in rows}),
        "verdicts": len(rows),
        "milder": sum(row["milder"] for row in rows),
        "milder_level": sum(ranks[row["level"]] > ranks[row["true_level"]] for row in rows),
        "same_level_pct": _share(sum(row["level"] == row["true_level"] for row in rows), len(rows)),
        "truly_clear": len(clear),
        "stop_where_clear": clear.count("stop"),
        "stop_where_clear_pct": _share(clear.count("stop"), len(clear)),
        "clear_where_clear_pct": _share(clear.count("clear"), len(clear)),
        **{f"truly_{name}_verdicts": sum(row["true_level"] == name for row in rows) for name in ranks},
    }


def _share(part: int, whole: int) -> float | None:
    """[%]; None of nothing."""
    return 100 * part / whole if whole else None
