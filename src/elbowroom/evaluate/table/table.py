"""Random poses of an arm on a table: which of the motions that are truly clear are stopped."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from elbowroom.errors import InputError, MachineWarning
from elbowroom.evaluate.due import Due, Row, where
from elbowroom.evaluate.own_links.exact import ExactLinks, Pair
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.evaluate.table.cell import TERMS, TOP_M, Cell, cell, near_the_table, on_the_table
from elbowroom.machine import Machine
from elbowroom.machine.ways import moves
from elbowroom.motion import Level, Motion, check_motions
from elbowroom.motion.contacts import watched_rows
from elbowroom.reconstruct import free_space_of
from elbowroom.sensing import Snapshot
from elbowroom.simulate import render
from elbowroom.simulate.machine_solids import link_solids, random_joints
from elbowroom.simulate.solid import Moment

SPEED, BRAKING_TIME_S = np.radians(30), 0.3
"""Of all joints that are asked [rad/s]."""
CLEAR_OF_M = 0.001
"""Links that move keep this far above the table's top where the arm stands [m]."""
ASKED = 3
"""Joints from the base on whose motions are asked: shoulder and elbow."""
ROUNDING = 1e-3
"""Travel counts as longer than the truth from so much on [rad]."""
DUE = (
    Due(
        "stop_where_clear_pct",
        "≤",
        15.0,
        where(kind="summary", contact=True),
        "motions of shoulder and elbow that are truly clear and stop, with declared contact",
    ),
    Due("milder", "≤", 0.0, where(kind="summary"), "motions that meet something within S and do not stop"),
)
"""What is due."""


class _Arm(NamedTuple):
    """An arm on the table, the truth about it and about the bin beside it, and what is asked of it."""

    machine: Machine
    exact: ExactTravel
    beside: ExactTravel
    own: ExactLinks
    pairs: list[Pair]
    motions: list[Motion]


def table_rows(
    urdf: Path, links: Sequence[str], poses: int, voxel_size_m: float, size: str, seed: int = 0
) -> Iterator[dict[str, Any]]:
    """A row for each pose and motion, without declared contact and with it.

    Args:
        urdf: of the arm, whose base is its first link.
        links: that may be near the table.
        poses: how many.
        voxel_size_m: edge of a voxel [m].
        size: of images.
        seed: of poses and noise.

    Raises:
        InputError: no pose is found in which the arm touches nothing.
        PackageError: coal is not installed.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MachineWarning)
        machine = on_the_table(Machine.from_urdf(urdf))
    place = cell(voxel_size_m, size)
    arm = _Arm(
        machine,
        ExactTravel(machine, place.solids),
        ExactTravel(machine, [solid for solid in place.solids if solid.name == "bin"]),
        ExactLinks(machine),
        watched_rows(machine),
        [
            Motion(name, way, SPEED * BRAKING_TIME_S / 2)
            for name in machine.joint_names[:ASKED]
            for way in (1, -1)
        ],
    )
    random = np.random.default_rng(seed)
    for pose in range(poses):
        joints = _standing(arm, random)
        moment = Moment(float(pose), (*place.solids, *link_solids(machine, joints)), joints)
        snapshot = Snapshot(tuple(render(place.cameras, moment, seed=seed)), joints)
        truths = [_truth(arm, joints, motion) for motion in arm.motions]
        for contact, asked in ((False, machine), (True, near_the_table(machine, tuple(links)))):
            for motion, truth, row in zip(
                arm.motions, truths, _verdicts(place, asked, snapshot, arm.motions), strict=True
            ):
                yield {
                    "kind": "verdict",
                    "pose": pose,
                    "contact": contact,
                    "motion": motion.name,
                    "truth": truth,
                    **row,
                }


def _standing(arm: _Arm, random: np.random.Generator) -> dict[str, float]:
    """A pose in which no link comes near anything, but those that stand on the table."""
    machine = arm.machine
    for _ in range(10_000):
        joints = random_joints(machine, random)
        placed = machine.world_from_links(joints)
        lowest = [
            float((link.vertices @ placed[link.name][2, :3] + placed[link.name][2, 3]).min())
            for row, link in enumerate(machine.links)
            if link.has_geometry and moves(machine, row)
        ]
        if min(lowest) < TOP_M + CLEAR_OF_M or arm.own.touching(joints, arm.pairs):
            continue
        if arm.beside.gap(joints, CLEAR_OF_M) >= CLEAR_OF_M:
            return joints
    raise InputError(f"{machine.name}: no pose was found in which it stands on a table and touches nothing")


def _truth(arm: _Arm, joints: Mapping[str, float], motion: Motion) -> float | None:
    """How far a motion can go until a link touches anything, itself too; None: nothing as far as is looked."""
    contact = arm.exact.until_contact(joints, motion)
    far = Motion(motion.joint, motion.direction, motion.looked_at)
    own, pair = arm.own.until_contact(joints, far, arm.pairs)
    ends = ([contact.travel] if contact.touches else []) + ([own] if pair is not None else [])
    return min(ends, default=None)


def _verdicts(
    place: Cell, machine: Machine, snapshot: Snapshot, motions: Sequence[Motion]
) -> Iterator[dict[str, Any]]:
    space = free_space_of(place.grid, place.cameras, snapshot, machine, TERMS)
    for verdict in check_motions(space, machine, snapshot.joints or {}, motions):
        yield {
            "level": verdict.level.name.lower(),
            "cause": verdict.cause.name.lower(),
            "link": verdict.link,
            "other_link": verdict.other_link,
            "free_travel": verdict.free_travel,
        }


def table_summary(rows: Sequence[Row]) -> list[Row]:
    """What the rows come to, without declared contact and with it."""
    braking = SPEED * BRAKING_TIME_S / 2
    summaries: list[Row] = []
    for contact in (False, True):
        of = [row for row in rows if row["contact"] is contact]
        clear = [row for row in of if row["truth"] is None]
        within = [row for row in of if row["truth"] is not None and row["truth"] <= braking]
        stop = sum(row["level"] == Level.STOP.name.lower() for row in clear)
        summaries.append(
            {
                "kind": "summary",
                "contact": contact,
                "poses": len({row["pose"] for row in of}),
                "motions": len(of),
                "clear": len(clear),
                "stop_where_clear": stop,
                "stop_where_clear_pct": 100 * stop / max(len(clear), 1),
                "within": len(within),
                "milder": sum(row["level"] != Level.STOP.name.lower() for row in within),
                "beyond": sum(
                    row["truth"] is not None and row["free_travel"] > row["truth"] + ROUNDING for row in of
                ),
            }
        )
    return summaries
