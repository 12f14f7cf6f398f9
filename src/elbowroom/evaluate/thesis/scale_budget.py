"""Where the scale model's free travel is lost: millimetres for each cause, over the ways in view, by size of voxel.

The last row is of poses for which the cameras were not placed. Each cause is added to those before it, and says how far
free travel ends before the truth, median and worst: *voxels* are those that the true objects touch, in an else open
space; *view* ends where the first voxel is that no camera sees all of, by exact rays; *pixels* are exact images,
*margin* the same with three sigmas of a Kinect allowed for, *noise* images with that noise.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Row
from elbowroom.evaluate.rooms.scene import WELL_KNOWN
from elbowroom.evaluate.shares.work_force import do_work
from elbowroom.evaluate.tables import Cell, table_of
from elbowroom.evaluate.thesis.scale import EXPLAIN_M, near_m, noisy_frames
from elbowroom.evaluate.thesis.scale_model import (
    POSES,
    VOXEL_SIZES_M,
    body_growth,
    kinects,
    model_grid,
    model_machine,
    model_pose,
    model_solids,
)
from elbowroom.evaluate.thesis.way_view import WayView
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import body_words
from elbowroom.motion import Motion, blocks_in_reach, check_motions
from elbowroom.reconstruct import FreeSpace, reconstruct
from elbowroom.simulate import Moment, true_occupancy
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.view.report.blocks import Table

CAUSES = ("voxels", "view", "pixels", "margin", "noise")
IMAGES = ((False, False), (True, False), (True, True))
"""For the last three of these: whether noise is allowed for, and whether images have it."""
Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Group:
    """Poses that come to one row.

    Args:
        voxel_size_m: edge of a voxel [m].
        first, count: number of the first pose, and how many.
    """

    voxel_size_m: float
    first: int
    count: int

    @property
    def judged(self) -> bool:
        """Whether the cameras were placed for these poses."""
        return self.first == 0

    @property
    def words(self) -> str:
        """As tables and messages call it."""
        return _words(self.voxel_size_m, self.judged)


def groups(poses: int = POSES, voxel_sizes_m: Sequence[float] = VOXEL_SIZES_M) -> list[Group]:
    """The poses that are judged by each size of voxel, then as many others by the smallest.

    Args:
        poses: how many of those that are judged.
        voxel_sizes_m: edges of voxels [m of the model].
    """
    return [*(Group(edge, 0, poses) for edge in voxel_sizes_m), Group(min(voxel_sizes_m), POSES, poses)]


def scale_budget_rows(tell: Tell, asked: Sequence[Group], *, jobs: int = 1) -> Iterator[dict[str, Any]]:
    """A row for each group.

    Args:
        tell: told what is being done.
        asked: as `groups` gives them.
        jobs: processes on this computer.

    Yields:
        Rows of voxel_size_m, judged, motions, in_view, short_mm: by cause the median and the worst [mm].

    Raises:
        PackageError: coal is not installed.
    """
    for group in asked:
        poses = range(group.first, group.first + group.count)
        tell(f"{group.words}: 0 of {group.count} poses")
        found: dict[int, list[list[float]]] = {}
        for index, of_pose in do_work([partial(shortfalls, n, group.voxel_size_m) for n in poses], jobs=jobs):
            found[index] = of_pose
            tell(f"{group.words}: {len(found)} of {group.count} poses")
        yield budget_row(group, [row for index in range(group.count) for row in found[index]])


def budget_row(group: Group, shortfalls_mm: Sequence[Sequence[float]]) -> dict[str, Any]:
    """Median and worst over the ways in view; None where there is none.

    Args:
        group: whose motions.
        shortfalls_mm: for each motion by each of `CAUSES` [mm].
    """
    rows = np.array(shortfalls_mm)
    mine = rows[rows[:, CAUSES.index("view")] <= 1000 * near_m(group.voxel_size_m)]
    pairs: list[list[float | None]] = [
        [round(float(np.median(mm)), 2), round(float(mm.max()), 2)] for mm in mine.T if len(mm)
    ]
    return {
        "voxel_size_m": group.voxel_size_m,
        "judged": group.judged,
        "motions": len(rows),
        "in_view": len(mine),
        "short_mm": dict(zip(CAUSES, pairs or [[None, None]] * len(CAUSES), strict=True)),
    }


def budget_table(rows: Sequence[Row]) -> Table:
    """Median and worst for each cause."""

    def pair(cause: str) -> Cell:
        return lambda row: " / ".join("-" if mm is None else f"{mm:.1f}" for mm in row["short_mm"][cause])

    columns: dict[str, Cell] = {
        "voxel": lambda row: _words(row["voxel_size_m"], row["judged"]),
        "ways in view": "{in_view} of {motions}",
    }
    title = "Ways in view: short by, median / worst [mm], each column with one cause more"
    return table_of(title, rows, columns | {cause: pair(cause) for cause in CAUSES}, left=("voxel",))


def _words(voxel_size_m: float, judged: bool) -> str:
    return f"{1000 * voxel_size_m:g} mm{'' if judged else ', other poses'}"


def shortfalls(pose: int, voxel_size_m: float) -> list[list[float]]:
    """For each motion of a pose, how much its travel ends before the truth by each of `CAUSES` [mm]."""
    machine, grid = model_machine(), model_grid(voxel_size_m)
    joints, met = model_pose(pose)
    motions = list(met)
    moment = Moment(1.0, model_solids() + link_solids(machine, joints), joints)
    spaces = _spaces(pose, grid, moment, motions)
    travels = [[v.free_travel for v in check_motions(space, machine, joints, motions)] for space in spaces]
    view = WayView(machine, moment, grid, body_growth(voxel_size_m))
    seen = [
        view.travel_in_view(view.way(motion, contact.travel), kinects(False), contact.travel)
        for motion, contact in met.items()
    ]
    rows = zip(met.values(), travels[0], seen, *travels[1:], strict=True)
    return [[1000 * (c.travel - travel) * c.speed for travel in row] for c, *row in rows]


def _spaces(pose: int, grid: VoxelGrid, moment: Moment, motions: Sequence[Motion]) -> list[FreeSpace]:
    """The open space but for what the true objects touch, then what is seen to be free by each of `IMAGES`."""
    machine, joints, growth_m = model_machine(), moment.joints, body_growth(grid.voxel_size_m)
    occupied = true_occupancy(grid, moment).occupied
    body = bits.unpack(body_words(machine, joints, grid, growth_m), grid)
    focus = blocks_in_reach(grid, machine, joints, motions)
    seen = [
        reconstruct(
            grid,
            kinects(allowed),
            noisy_frames(kinects(noise), moment, pose),
            machine=machine,
            joints=joints,
            margin=WELL_KNOWN,
            explain_tolerance_m=EXPLAIN_M,
            body_growth_m=growth_m,
            focus=focus,
            looks=False,
        )
        for allowed, noise in IMAGES
    ]
    return [FreeSpace.from_occupied(grid, occupied & ~body), *seen]
