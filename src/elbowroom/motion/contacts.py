"""Which links of a machine must not meet, and which touch as they are meant to."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.geometry.kernels.bits import plain
from elbowroom.machine import Machine
from elbowroom.machine.boxes import boxes_of
from elbowroom.machine.kernels.apart import Bodies
from elbowroom.machine.kernels.samples import cluster
from elbowroom.machine.names import is_named
from elbowroom.machine.overlap import POSES, always_touching, bodies_of
from elbowroom.machine.samples import COVER_IN_VOXELS, ROUNDING_M, BodySamples, body_samples
from elbowroom.machine.shape import Shape
from elbowroom.machine.things import with_things
from elbowroom.machine.ways import moves
from elbowroom.motion.field import fields_of
from elbowroom.motion.kernels.field import Fields, slack_of
from elbowroom.motion.kernels.meeting import RUN, Pairs
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.skin import bare_skin

SAMPLES = 8_000
"""A machine's surface has about so many samples here; a robot of 1 m2 is covered to within 6 mm."""
FINEST = 1 / 8
"""A field's cells are no smaller than this share of the voxels that the samples would do for."""
COARSER = 1.5
"""A field is much coarser than another whose cells are smaller than its own by this factor."""


@kept
def pairs_of(machine: Machine) -> Pairs:
    """The pairs of a machine's links that must not meet; made once per machine, then kept.

    And links with the things of the machine's contacts, which are links of `with_things`.

    Left out are links and the next one up the tree that has a body, those that the machine's `allowed_contacts` or
    `own_links` name, those that touch in all poses, and pairs of unchecked links.

    Args:
        machine: whose links.

    Raises:
        MachineError: as `body_samples`.
    """
    rows = [*watched_rows(machine), *_near_things(machine)]
    edge = _voxel_for(machine)
    skin, width = _skin(body_samples(machine, edge, unchecked=True))
    whole = with_things(machine)
    fields = fields_of(whole.links, {row for pair in rows for row in pair}, FINEST * edge)
    return _pairs(skin, width, fields, bodies_of(whole.shape, rows))


def _near_things(machine: Machine) -> list[tuple[int, int]]:
    """The rows of links that may be near things, and those of the things that they may not touch."""
    return [
        (row, len(machine.links) + n)
        for n, contact in enumerate(machine.contacts)
        for row, link in enumerate(machine.links)
        if link.has_geometry and contact.names(link.name) and moves(machine, row) and not contact.may_touch
    ]


def watched_rows(machine: Machine) -> list[tuple[int, int]]:
    """The rows of the links of each pair that must not meet."""
    rows = [pair for pair in _may_not_touch(machine) if can_move_apart(machine, *pair)]
    always = always_touching(machine.shape, rows, machine.random_places(POSES))
    return [pair for pair, touch in zip(rows, always, strict=True) if not touch]


def _voxel_for(machine: Machine) -> float:
    """The edge of voxels for which a machine's surface takes about `SAMPLES` [m]."""
    corners = np.concatenate([link.triangles for link in machine.links])
    area = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2
    )
    # flat parts take a sample for each square that fits into the circle which it covers
    return float(np.sqrt(area / SAMPLES / 2) / COVER_IN_VOXELS)


def _may_not_touch(machine: Machine) -> list[tuple[int, int]]:
    bodies = [row for row, link in enumerate(machine.links) if link.has_geometry]
    names = machine.link_names
    return [
        (a, b)
        for a, b in combinations(bodies, 2)
        if not (names[a] in machine.unchecked_links and names[b] in machine.unchecked_links)
        and a not in (next_body(machine, b),)
        and not is_allowed(machine, names[a], names[b])
    ]


def is_allowed(machine: Machine, one: str, other: str) -> bool:
    """Whether a machine's `allowed_contacts` let two links touch, or its `own_links` say not to compare them.

    Args:
        machine: whose links.
        one, other: their names, in either order.
    """
    if machine.own_links is not None and machine.own_links.has(one, other):
        return True
    return any(
        (is_named(one, a) and is_named(other, b)) or (is_named(one, b) and is_named(other, a))
        for a, b in machine.allowed_contacts
    )


def next_body(machine: Machine, row: int) -> int:
    """The next link up the tree that has a body; -1: none."""
    parent = int(machine.tree.parent[row])
    while parent >= 0 and not machine.links[parent].has_geometry:
        parent = int(machine.tree.parent[parent])
    return parent


def can_move_apart(machine: Machine, a: int, b: int) -> bool:
    """Whether a joint lies between two links.

    Args:
        machine: whose links.
        a, b: their rows.
    """
    return _stiff_with(machine, a) != _stiff_with(machine, b)


def _stiff_with(machine: Machine, row: int) -> int:
    """The first link up the tree that a link is fixed to."""
    while machine.tree.column[row] < 0 and machine.tree.parent[row] >= 0:
        row = int(machine.tree.parent[row])
    return row


def _pairs(skin: Skin, width: NDArray[np.float64], fields: Fields, bodies: Bodies) -> Pairs:
    """The kernels' pairs: samples of the link farther from the base, of which each cluster has a speed of its own.

    But where the other link's field is much coarser, it gives the samples; things give none.

    Args:
        skin, width, fields, bodies: as of `Pairs`.
    """
    rows = list(zip(bodies.one.tolist(), bodies.other.tolist(), strict=True))
    clusters = {row: np.flatnonzero(skin.link == row) for pair in rows for row in pair}
    by_side = [
        (b, a) if clusters[b].size and fields.edge[a] <= COARSER * fields.edge[b] else (a, b) for a, b in rows
    ]
    members = [clusters[sampled] for sampled, _ in by_side]
    return Pairs(
        skin=skin,
        width=width,
        fields=fields,
        sampled=np.array([a for a, _ in by_side], dtype=np.int64),
        other=np.array([b for _, b in by_side], dtype=np.int64),
        doubt=np.array([skin.cover + plain(slack_of)(fields.edge[b]) for _, b in by_side]),
        pair=np.repeat(np.arange(len(rows)), [len(own) for own in members]),
        cluster=np.concatenate([np.zeros(0, dtype=np.int64), *members]),
        bodies=bodies,
    )


def _skin(samples: BodySamples) -> tuple[Skin, NDArray[np.float64]]:
    """The samples, sorted within their clusters into runs, without triangles; and how wide each run is."""
    order = np.arange(len(samples.points))
    for start, stop in zip(samples.cluster_start, samples.cluster_stop, strict=True):
        within = np.empty(stop - start, dtype=np.int64)
        cluster(samples.points[start:stop], RUN, within, np.empty(stop - start + 1, dtype=np.int64))
        order[start:stop] = start + within
    points = samples.points[order]
    sizes = samples.cluster_stop - samples.cluster_start
    place = np.arange(len(points)) - np.repeat(samples.cluster_start, sizes)
    first = np.arange(len(points)) - place % RUN
    width = np.zeros(len(points))
    np.maximum.at(width, first, np.linalg.norm(points - points[first], axis=1) + ROUNDING_M)
    return bare_skin(samples, points), width


@kept
def parts_of(shape: Shape) -> Skin:
    """The parts of all links, as `cluster_speeds` takes what moves: a ball for each."""
    boxes = boxes_of(shape)
    _, first = np.unique(boxes.part, return_index=True)
    none = np.zeros(0, dtype=np.int64)
    return Skin(
        points=np.zeros((0, 3), dtype=np.float32),
        cluster_of=none,
        start=none,
        stop=none,
        link=boxes.link[first],
        centre=boxes.centre[first],
        radius=np.linalg.norm(boxes.half[first], axis=1),
        half=boxes.half[first],
        cover=0.0,
        off=0.0,
        triangles=np.zeros((0, 3, 3)),
        patches=none,
        patch_start=none,
        columns=np.zeros((3, 0), dtype=np.float32),
    )
