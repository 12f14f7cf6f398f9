"""How far each link is from what was seen, and from what nobody saw.

A distance is that of the link's surface samples to the boxes of blocked voxels, less the samples' covering radius, so
it is never more than the truth: than the distance of the link's surface to those boxes, which hold whatever is there.
It falls short of the distance to the boxes by `Distances.slack_m` at most, and of that to what is in a box by the box's
diagonal besides.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kept import kept
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine, body_samples
from elbowroom.machine.samples import ROUNDING_M as SAMPLE_ROUNDING_M
from elbowroom.machine.samples import BodySamples
from elbowroom.machine.shape import Shape
from elbowroom.motion.ground import Ground, grounds_of
from elbowroom.motion.kernels.mover import ROUNDING_M
from elbowroom.motion.kernels.nearest import NOTHING, OUTSIDE, VOXEL, Marks, lies_in_marked, nearest
from elbowroom.reconstruct.free_space import FreeSpace


@dataclass(frozen=True, slots=True)
class Nearest:
    """The nearest of what is asked for.

    Args:
        distance_m: never more than the truth; at most as far as was looked [m].
        link: from which it is so far.
        place_in_world: the middle of the nearest voxel, or a point of the grid's side [m]; None: nothing is nearer than
            was looked.
        is_outside: whether it is what lies outside the grid.
    """

    distance_m: float
    link: str
    place_in_world: tuple[float, float, float] | None = None
    is_outside: bool = False

    @property
    def is_there(self) -> bool:
        """Whether anything is nearer than was looked."""
        return self.place_in_world is not None

    def row(self) -> dict[str, Any]:
        """As a file has it."""
        place = None if self.place_in_world is None else list(self.place_in_world)
        return {
            "distance_m": self.distance_m,
            "link": self.link,
            "place_in_world": place,
            "is_outside_grid": self.is_outside,
        }


@dataclass(frozen=True, slots=True)
class LinkDistances:
    """How far one link is from blocked space.

    Args:
        link: its name.
        seen: from the nearest surface that was measured.
        unseen: from the nearest space that nobody saw to be free, and in which no surface was measured.
    """

    link: str
    seen: Nearest
    unseen: Nearest

    @property
    def blocked(self) -> Nearest:
        """From the nearer of both."""
        return min(self.seen, self.unseen, key=lambda one: one.distance_m)


@dataclass(frozen=True, slots=True)
class Distances:
    """How far the links of a machine are from blocked space.

    Args:
        up_to_m: so far it was looked [m].
        slack_m: a distance may be less than that to the nearest voxel by so much, at most [m].
        links: of each checked link.
    """

    up_to_m: float
    slack_m: float
    links: tuple[LinkDistances, ...]

    @property
    def seen(self) -> Nearest | None:
        """The nearest surface of any link; None: no link is checked."""
        return min((link.seen for link in self.links), key=_order, default=None)

    @property
    def unseen(self) -> Nearest | None:
        """The nearest space of any link that nobody saw; None: no link is checked."""
        return min((link.unseen for link in self.links), key=_order, default=None)


def link_distances(
    space: FreeSpace, machine: Machine, joints: Mapping[str, float], up_to_m: float
) -> Distances:
    """How far each checked link is from what was seen, and from what nobody saw, where the machine stands.

    *Seen* is a blocked voxel in which a surface was measured, *unseen* any other one that is blocked, and all that lies
    outside the grid; one that no camera was asked of is both. What is made free for a link (what it may touch, where
    nobody watches) is not there for it; a zone to keep out of is blocked, but it is no space that hides anything. Less
    evidence leaves more blocked, so the nearer of both is never farther with less of it.

    Args:
        space: the free space, the machine's own voxels taken out.
        machine: the machine.
        joints: where it is now, by name [m or rad].
        up_to_m: greater distances are not worked out [m].

    Raises:
        InputError: a distance that is not a finite number above 0.
        MachineError: as `Machine.positions`.
    """
    if not (np.isfinite(up_to_m) and up_to_m > 0):
        raise InputError(f"distances: up_to_m is {up_to_m}, must be a finite number above 0 [m]")
    placed = machine.world_from_link_array(machine.positions(joints)[None])[0]
    samples = body_samples(machine, space.grid.voxel_size_m)
    looks = [
        _Look(machine, samples, _points_within(machine.shape, samples), marks, row, placed[row], up_to_m)
        for row, both in sorted(_marks_by_row(space, machine, samples).items())
        for marks in both
    ]
    found = spread(_Look.nearest, looks)
    slack_m = samples.cover_m + samples.bound_m + SAMPLE_ROUNDING_M + ROUNDING_M
    pairs = zip(found[::2], found[1::2], strict=True)
    links = tuple(LinkDistances(seen.link, seen, unseen) for seen, unseen in pairs)
    return Distances(up_to_m, slack_m, links)


def _marks_by_row(space: FreeSpace, machine: Machine, samples: BodySamples) -> dict[int, tuple[Marks, Marks]]:
    """By the row of each checked link, the marks of what was seen for it, then of what nobody saw."""
    grounds = [(ground.links, _marks_of(ground, space)) for ground in grounds_of(space, machine)]
    rows = np.unique(samples.cluster_link).tolist()
    return {row: marks for links, marks in grounds for row in rows if links[row]}


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """What is asked of one link: how far it is from what is marked."""

    machine: Machine
    samples: BodySamples
    within: tuple[NDArray[np.float32], ...]
    marks: Marks
    row: int
    placed: NDArray[np.float64]
    up_to_m: float

    def nearest(self) -> Nearest:
        link, marks = self.machine.link_names[self.row], self.marks
        place, less = np.zeros(3), self.samples.cover_m + ROUNDING_M
        if lies_in_marked(self.placed, self.within[self.row], marks, place):
            return Nearest(0.0, link, _as_place(place))
        first, last = np.searchsorted(self.samples.cluster_link, [self.row, self.row + 1])
        distance, kind = nearest(
            self.placed, self.samples.clusters, first, last, marks, self.up_to_m + less, place
        )
        if kind == NOTHING:
            return Nearest(self.up_to_m, link)
        assert kind in (VOXEL, OUTSIDE)
        return Nearest(max(0.0, distance - less), link, _as_place(place), kind == OUTSIDE)


def _marks_of(ground: Ground, space: FreeSpace) -> tuple[Marks, Marks]:
    """What was seen of what blocks a ground's links, and what nobody saw; the grid's outside is of that."""
    blocked = ground.volume.words & ~space.free_words
    seen: Words = blocked & space.surface_words
    if space.looked_at is not None:  # there may be a surface
        seen = np.where(space.looked_at, seen, blocked)
    return _marks(seen, ground, False), _marks(blocked & ~space.surface_words, ground, True)


def _marks(words: Words, ground: Ground, outside: bool) -> Marks:
    return Marks(ground.volume.lattice, words, (words.reshape(-1, 64) != 0).any(axis=1), outside)


@kept
def _points_within(shape: Shape, samples: BodySamples) -> tuple[NDArray[np.float32], ...]:
    """By link, the points that lie in it: what the whole body covers has one of them in it."""
    return tuple(
        np.ascontiguousarray(samples.interior[samples.interior_link == row])
        for row in range(len(shape.links))
    )


def _as_place(place: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = place.tolist()
    return x, y, z


def _order(one: Nearest) -> tuple[float, bool]:
    """The nearest first; of what is at one distance, what is there before what is not."""
    return one.distance_m, not one.is_there
