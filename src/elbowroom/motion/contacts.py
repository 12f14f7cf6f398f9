"""Which links of a machine must not meet, and which touch as they are meant to."""

from fnmatch import fnmatchcase
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.machine.samples import BodySamples, body_samples
from elbowroom.motion.field import fields_of
from elbowroom.motion.kernels.field import Fields, slack_of
from elbowroom.motion.kernels.meeting import Pairs, gaps_now
from elbowroom.motion.kernels.mover import Skin

COARSE_M = 0.04
"""Samples for voxels of this size, or of twice the room's if they are smaller, stand for the links [m]."""
FINEST = 1 / 12
"""A field's cells are no smaller than this share of that size."""
POSES, ALWAYS = 40, 0.95
"""Links that lie in each other in this share of so many poses, drawn from the joints' limits, are meant to."""


@kept
def pairs_of(machine: Machine, voxel_size_m: float) -> Pairs:
    """The pairs of a machine's links that must not meet; made once per machine and size, then kept.

    Left out are links and the next one up the tree that has a body, those that the machine's `allowed_contacts` name,
    those that lie in each other in all poses, and pairs of unchecked links.

    Args:
        machine: whose links.
        voxel_size_m: edge of the room's voxels [m].

    Raises:
        MachineError: as `body_samples`.
    """
    edge = min(2 * voxel_size_m, max(COARSE_M, voxel_size_m / 2))
    rows = [pair for pair in _may_not_touch(machine) if _can_move_apart(machine, *pair)]
    if not rows:
        return _empty(machine)
    samples = body_samples(machine, edge, unchecked=True)
    found = _pairs(samples, fields_of(machine, FINEST * edge), rows)
    kept_apart = ~_always_touch(machine, found)
    return _pairs(samples, found.fields, [pair for pair, keep in zip(rows, kept_apart, strict=True) if keep])


def _may_not_touch(machine: Machine) -> list[tuple[int, int]]:
    bodies = [row for row, link in enumerate(machine.links) if link.has_geometry]
    names = machine.link_names
    return [
        (a, b)
        for a, b in combinations(bodies, 2)
        if not (names[a] in machine.unchecked_links and names[b] in machine.unchecked_links)
        and a not in (_next_body(machine, b),)
        and not is_allowed(machine, names[a], names[b])
    ]


def is_allowed(machine: Machine, one: str, other: str) -> bool:
    """Whether a machine's `allowed_contacts` let two links touch; names there may hold wildcards."""
    return any(
        (fnmatchcase(one, a) and fnmatchcase(other, b)) or (fnmatchcase(one, b) and fnmatchcase(other, a))
        for a, b in machine.allowed_contacts
    )


def _next_body(machine: Machine, row: int) -> int:
    """The next link up the tree that has a body; -1: none."""
    parent = int(machine.tree.parent[row])
    while parent >= 0 and not machine.links[parent].has_geometry:
        parent = int(machine.tree.parent[parent])
    return parent


def _can_move_apart(machine: Machine, a: int, b: int) -> bool:
    """Whether a joint lies between two links."""
    return _stiff_with(machine, a) != _stiff_with(machine, b)


def _stiff_with(machine: Machine, row: int) -> int:
    """The first link up the tree that a link is fixed to."""
    while machine.tree.column[row] < 0 and machine.tree.parent[row] >= 0:
        row = int(machine.tree.parent[row])
    return row


def _pairs(samples: BodySamples, fields: Fields, rows: list[tuple[int, int]]) -> Pairs:
    """The kernels' pairs: the link that is measured more finely gets the other's samples."""
    clusters = {row: np.flatnonzero(samples.cluster_link == row) for pair in rows for row in pair}
    fine_last = [(a, b) if fields.edge[b] <= fields.edge[a] else (b, a) for a, b in rows]
    members = [clusters[sampled] for sampled, _ in fine_last]
    none = np.zeros(0, dtype=np.int64)
    return Pairs(
        skin=Skin(
            points=samples.points,
            cluster_of=np.zeros(0, dtype=np.int32),
            start=samples.cluster_start,
            stop=samples.cluster_stop,
            link=samples.cluster_link,
            centre=samples.cluster_centre,
            radius=samples.cluster_radius,
            cover=samples.cover_m,
            triangles=np.zeros((0, 3, 3)),
            patches=np.zeros(0, dtype=np.int32),
            patch_start=none,
        ),
        fields=fields,
        sampled=np.array([a for a, _ in fine_last], dtype=np.int64),
        other=np.array([b for _, b in fine_last], dtype=np.int64),
        pair=np.repeat(np.arange(len(rows)), [len(own) for own in members]),
        cluster=np.concatenate([none, *members]),
    )


def _empty(machine: Machine) -> Pairs:
    nothing = np.zeros(0)
    none = np.zeros(0, dtype=np.int64)
    few = np.zeros(0, dtype=np.int32)
    skin = Skin(
        np.zeros((0, 3), dtype=np.float32), few, none, none, few, np.zeros((0, 3)), nothing, 0.0,
        np.zeros((0, 3, 3)), few, none,
    )
    fields = Fields(np.zeros(0, dtype=np.float32), none, np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3)), nothing)
    return Pairs(skin, fields, none, none, none, none)


def _always_touch(machine: Machine, pairs: Pairs) -> NDArray[np.bool_]:
    """Of each pair, whether its links lie in each other in all but a few poses."""
    rng = np.random.default_rng(0)
    joints = [machine.joint(name) for name in machine.joint_names]
    lower = np.array([max(joint.lower, -np.pi) for joint in joints])
    upper = np.array([min(joint.upper, np.pi) for joint in joints])
    placed = machine.world_from_link_array(rng.uniform(lower, upper, (POSES, len(joints))))
    touch = np.zeros(len(pairs.sampled))
    gaps, least = np.empty(len(pairs.pair)), np.empty(len(pairs.sampled))
    # what is told of a gap is less than the gap by this
    told_less = pairs.skin.cover + slack_of(pairs.fields.edge[pairs.other])
    for pose in placed:
        gaps_now(pairs, pose, 0.0, gaps, least)
        touch += least + told_less <= 0.0
    always: NDArray[np.bool_] = touch >= ALWAYS * POSES
    return always
