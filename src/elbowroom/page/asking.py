"""Cameras asked about the place where a motion ends: images of one pass, and what would change its verdict."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.monitor.why.changes import Change, changes_of
from elbowroom.monitor.why.why import why
from elbowroom.motion import Cause, Creep, Level, Motion, Verdict
from elbowroom.page.story.told import Told
from elbowroom.reconstruct import FreeSpace, free_space_of
from elbowroom.sensing import Snapshot


def changes_at(
    configuration: Configuration, told: Told, snapshot: Snapshot, number: int
) -> tuple[Change, ...] | None:
    """What would change a verdict, by the images of its pass; None: no image can say, as where nothing was judged.

    Args:
        configuration: of the run.
        told: the pass.
        snapshot: its images, and where the machine was.
        number: of the motion.
    """
    judged = told["judged"]
    row = judged["verdicts"][number]
    if judged["given"] is None or judged["stopped_by"] is not None or row["place_m"] is None:
        return None
    machine = configuration.machine
    if machine is None or snapshot.joints is None:
        return None
    grid: VoxelGrid = configuration.fields["grid"]
    verdict = verdict_of(row, configuration.motions[number])
    focus = _about(grid, row["place_m"])
    frames = tuple(frame for frame in snapshot.frames if frame.camera in judged["given"])
    given = replace(snapshot, frames=frames)
    terms = configuration.fields["terms"]
    space = free_space_of(grid, configuration.cameras, given, machine, terms, focus=focus)
    return changes_in(space, configuration, snapshot.joints, verdict)


def changes_in(
    space: FreeSpace, configuration: Configuration, joints: Mapping[str, float], verdict: Verdict
) -> tuple[Change, ...]:
    """What would change a verdict, by a space that keeps its images.

    Args:
        space: that was judged.
        configuration: of the run; with a machine.
        joints: where the machine was [m or rad].
        verdict: of the motion.
    """
    machine = configuration.machine
    assert machine is not None
    return changes_of(why(space, machine, joints, verdict), space)


def verdict_of(row: Mapping[str, Any], motion: Motion) -> Verdict:
    """A verdict as a row has it.

    Args:
        row: of `Verdict.row`, as JSON knows it.
        motion: that was asked.
    """
    place = row["place_m"]
    return Verdict(
        motion=motion,
        level=Level[row["level"].upper()],
        free_travel=float(row["free_travel"]),
        free_travel_unit=row["free_travel_unit"],
        link=row["link"],
        place_in_world=None if place is None else _three(place),
        cause=Cause[row["cause"].upper()],
        other_link=row["other_link"],
        escapes=row["escapes"],
        zone=row["zone"],
        creep=_creep(row["creep"]),
    )


def _creep(row: Mapping[str, Any] | None) -> Creep | None:
    if row is None:
        return None
    place = None if row["place_m"] is None else _three(row["place_m"])
    speed, brakes, travel = (float(row[name]) for name in ("speed", "braking_distance", "travel"))
    return Creep(speed, brakes, travel, Cause[row["cause"].upper()], row["link"], place)


def _three(place: Sequence[float]) -> tuple[float, float, float]:
    return float(place[0]), float(place[1]), float(place[2])


def _about(grid: VoxelGrid, place: Sequence[float]) -> NDArray[np.bool_]:
    """The block of the voxel at a place; none: it lies outside."""
    focus = np.zeros(bits.word_count(grid), dtype=np.bool_)
    if not grid.contains(place):
        return focus
    i, j, k = (int(n) for n in grid.index_of(place))
    focus[bits.place_of((i, j, k), grid)[0]] = True
    return focus
