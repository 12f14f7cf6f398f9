"""Free travel in the true volume beside exact mesh distance: what voxels and sweep cost, without cameras."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.rooms.scene import SAME, only, room_grid, room_motions, settings_of
from elbowroom.motion import check_motions
from elbowroom.reconstruct import FreeSpace
from elbowroom.simulate import InterventionRoom, true_occupancy

CLEAR_VOXELS = 2.0
"""So many voxels must be between machine and solids at the start."""
SAID = ("joint", "direction", "free_travel", "free_travel_unit", "cause")
"""What is kept of a verdict."""
DUE = (Due("more_than_truth", "≤", 0), Due("median_shortfall_voxels", "≤", 1.5))


def travel_rows(
    voxel_size_m: float = 0.02, *, poses: int = 200, seed: int = 3
) -> Iterator[dict[str, object]]:
    """Random moments and poses in the whole room, all joints and directions, in the volume of exact truth.

    The shortfall is how much less travel than exact is allowed: the way of the point that touches, in voxels.

    Args:
        voxel_size_m: edge of a voxel [m].
        poses: how many; all joints and directions of each.
        seed: of moments and poses.

    Yields:
        A row of kind "travel" for each pose and motion; without a shortfall where nothing is touched.

    Raises:
        PackageError: coal is not installed.
    """
    room = InterventionRoom()
    motions = room_motions(room.machine)
    grid = room_grid(voxel_size_m)
    rng = np.random.default_rng(seed)
    for pose in range(poses):
        while True:
            moment = room.random_moment(rng)
            truth = ExactTravel(room.machine, moment.solids)
            if truth.gap(moment.joints, CLEAR_VOXELS * voxel_size_m) >= CLEAR_VOXELS * voxel_size_m:
                break
        volume = FreeSpace.from_occupied(grid, true_occupancy(grid, moment).occupied)
        space = volume.without(room.machine, moment.joints)
        verdicts = check_motions(space, room.machine, moment.joints, motions)
        for motion, verdict in zip(motions, verdicts, strict=True):
            contact = truth.until_contact(moment.joints, motion)
            missing_m = (contact.travel - verdict.free_travel) * contact.speed
            yield {
                "kind": "travel",
                "pose": pose,
                "voxel_size_m": voxel_size_m,
                "seed": seed,
                **only(verdict.row(), SAID),
                "true_travel": contact.travel,
                "true_solid": contact.solid,
                "shortfall_voxels": missing_m / voxel_size_m if contact.touches else None,
            }


def travel_summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The row of kind "summary" for rows of `travel_rows`: travel beyond the truth, shortfall at contacts."""
    shortfalls = [row["shortfall_voxels"] for row in rows if row["shortfall_voxels"] is not None]
    untouched = [row for row in rows if row["shortfall_voxels"] is None]
    return {
        **settings_of(rows),
        "poses": len({row["pose"] for row in rows}),
        "motions": len(rows),
        "more_than_truth": sum(row["free_travel"] > row["true_travel"] + SAME for row in rows),
        "touching": len(shortfalls),
        "median_shortfall_voxels": float(np.median(shortfalls)) if shortfalls else None,
        "greatest_shortfall_voxels": max(shortfalls, default=None),
        "blocked_without_contact": sum(row["free_travel"] < row["true_travel"] - SAME for row in untouched),
    }
