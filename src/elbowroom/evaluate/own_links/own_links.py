"""Published robots in random poses: is a joint stopped where a link would touch another one, and only there?"""

import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError, MachineError, MachineWarning
from elbowroom.evaluate.due import Due, Row
from elbowroom.evaluate.own_links.exact import ExactLinks, Pair
from elbowroom.evaluate.robots.published import Published, published
from elbowroom.machine import Machine
from elbowroom.machine.own_links import OwnLinks
from elbowroom.machine.poses import drawn_between
from elbowroom.motion import Level, Motion
from elbowroom.motion.contacts import pairs_of
from elbowroom.motion.course import way_of
from elbowroom.motion.meeting import Meeting

BRAKING = {"rad": 0.25, "m": 0.1}
"""Braking distances of joints that turn and that slide."""
LATE_SHARE = 2e-3
"""Travel counts as longer than the truth from this share of the braking distance on: what the truth is rounded by."""
DRAWS = 40
"""So often a pose is drawn anew, nearer and nearer to the middle of the joints' ranges, until no links touch."""

DUE = (
    Due("called_clear", "≤", 0.0, words="motions that meet a link within S and are called clear"),
    Due("false_stops_pct", "≤", 2.0, words="stops of motions that meet no link within S"),
)
"""What is due of all robots together."""


def own_link_rows(
    folders: Sequence[Path], robots: int, poses: int, seed: int = 0
) -> Iterator[dict[str, Any]]:
    """A row for each robot: the first description in each package's folder that has links which could meet.

    Args:
        folders: in which packages of robots were unpacked or installed.
        robots: how many.
        poses: of each, in which no links touch.
        seed: of the poses.

    Raises:
        InputError: a folder that is not there, or no description in any of them.
        PackageError: coal is not installed.
    """
    taken: set[Path] = set()
    for file in published(folders):
        own = next(
            (above for above in file.path.parents if above.name in ("urdf", "robots")), file.path
        ).parent
        if file.path.suffix.lower() != ".urdf" or own in taken or len(taken) == robots:
            continue
        machine = _machine(file)
        if machine is not None and machine.joint_names and len(pairs_of(machine.anywhere).sampled):
            taken.add(own)
            yield _row(file, machine, poses, seed)
    if not taken:
        raise InputError(f"{', '.join(map(str, folders))}: no robot below whose links could meet")


def _machine(file: Published) -> Machine | None:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MachineWarning)
            return Machine.from_urdf(file.path)
    except MachineError:
        return None


def _row(file: Published, machine: Machine, poses: int, seed: int) -> dict[str, Any]:
    exact, random = ExactLinks(machine), np.random.default_rng(seed)
    bodies = pairs_of(machine.anywhere).bodies
    every = list(zip(bodies.one.tolist(), bodies.other.tolist(), strict=True))
    at_rest = exact.touching(machine.nearest_to_zero(), every)
    if at_rest:
        machine = machine.comparing(_not_compared(machine, at_rest))
    pairs = [pair for pair in every if pair not in at_rest]
    counts = dict.fromkeys(("poses", "motions", "meet", "called_clear", "beyond", "stops", "false_stops"), 0)
    spent = 0.0
    _asked(machine, machine.nearest_to_zero())  # what is made once
    for _ in range(poses):
        joints = _drawn(machine, exact, pairs, random)
        if joints is None:
            continue
        counts["poses"] += 1
        begun = time.perf_counter()
        found = _asked(machine, joints)
        spent += time.perf_counter() - begun
        for motion, travel in found:
            truth, touched = exact.until_contact(joints, motion, pairs)
            stop = Level.at(travel, motion.braking_distance) is Level.STOP and travel < motion.looked_at
            counts["motions"] += 1
            counts["meet"] += touched is not None
            counts["stops"] += stop
            counts["called_clear"] += touched is not None and not stop
            counts["beyond"] += touched is not None and travel > truth + LATE_SHARE * motion.braking_distance
            counts["false_stops"] += stop and touched is None
    return {
        "kind": "robot",
        "package": file.package,
        "version": file.version,
        "file": file.name,
        "links": int(sum(link.has_geometry for link in machine.links)),
        "triangles": int(sum(len(link.faces) for link in machine.links)),
        "pairs": len(pairs),
        "touch_at_zero": len(at_rest),
        **counts,
        "ms_a_pose": round(1e3 * spent / max(counts["poses"], 1), 3),
    }


def _not_compared(machine: Machine, pairs: Sequence[Pair]) -> OwnLinks:
    """Pairs that touch where all joints are at zero, as MoveIt's setup assistant leaves them out."""
    names = machine.link_names
    return OwnLinks("at zero", tuple((names[a], names[b], "default") for a, b in pairs))


def _drawn(
    machine: Machine, exact: ExactLinks, pairs: Sequence[Pair], random: np.random.Generator
) -> dict[str, float] | None:
    """A random pose in which no links touch, as those of a machine that stands there; None: none was found."""
    rest = np.array([machine.nearest_to_zero()[name] for name in machine.joint_names])
    ends = np.array([drawn_between(machine.joint(name)) for name in machine.joint_names]).reshape(-1, 2)
    for draw in range(DRAWS):
        there = rest + (1 - draw / DRAWS) * (random.uniform(ends[:, 0], ends[:, 1]) - rest)
        pose = dict(zip(machine.joint_names, there.tolist(), strict=True))
        if not exact.touching(pose, pairs):
            return pose
    return None


def _asked(machine: Machine, joints: Mapping[str, float]) -> list[tuple[Motion, float]]:
    """How far each joint that no other follows may go in both directions, as the swept check says it."""
    start = machine.positions(joints)
    meeting = Meeting.of(machine, machine.world_from_link_array(start[None])[0])
    led = {joint.mimic.joint for joint in machine.joints if joint.mimic is not None}
    found = []
    for name in machine.joint_names:
        for direction in (1, -1) if name not in led else ():
            motion = Motion(name, direction, BRAKING[machine.joint(name).unit])
            way = way_of(machine, start, motion)
            met = meeting.first(way, way.length)
            found.append((motion, motion.looked_at if met is None else met.travel))
    return found


def own_link_summary(rows: Sequence[Row]) -> list[Row]:
    """What all robots come to."""
    total = {
        key: sum(row[key] for row in rows)
        for key in ("poses", "motions", "meet", "called_clear", "beyond", "stops", "false_stops")
    }
    clear = max(total["motions"] - total["meet"], 1)
    return [
        {
            "kind": "summary",
            "robots": len(rows),
            **total,
            "false_stops_pct": 100 * total["false_stops"] / clear,
            "ms_a_pose": round(float(np.median([row["ms_a_pose"] for row in rows])), 3),
        }
    ]
