"""Whether and when a machine meets itself on its way."""

from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.machine.kernels.apart import apart_now
from elbowroom.machine.kernels.body import FIXED
from elbowroom.machine.overlap import TOUCH_M
from elbowroom.machine.things import with_things
from elbowroom.motion.contacts import pairs_of, parts_of
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.closing import Travelling
from elbowroom.motion.kernels.meeting import Now, Pairs, Steps, first_meeting, gaps_now
from elbowroom.motion.kernels.mover import Mover
from elbowroom.motion.meeting_beside import first_stop_meeting
from elbowroom.motion.sweep import cluster_speeds

STEP_IN_COVERS = 2.0
"""No step of samples is shorter than what moves them by so many covering radii of samples."""
TOGETHER = 1 / 64
"""Looks that lie nearer to each other than this share of the way are done at one place."""


class Met(NamedTuple):
    """Where a way ends since the machine meets itself: the travel, the two links, the one that moves more first, and
    the place [m]."""

    travel: float
    link: str
    other: str
    place_in_world: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """The links of a machine that must not meet, and how far apart they are now.

    Args:
        machine: the machine, with things that stand still beside it.
        pairs: of its links.
        world_from_link: where they are, shape (n_links, 4, 4).
        now: how far apart they are there.
    """

    machine: Machine
    pairs: Pairs
    world_from_link: NDArray[np.float64]
    now: Now

    @classmethod
    def of(cls, machine: Machine, world_from_link: NDArray[np.float64]) -> Self:
        """At one place of the machine, whose links are there: shape (n_links, 4, 4)."""
        pairs, whole = pairs_of(machine.anywhere), with_things(machine)
        things = np.tile(machine.world_from_base, (len(machine.contacts), 1, 1))
        placed = np.concatenate([world_from_link, things]) if len(things) else world_from_link
        apart, gaps, least = (np.empty(len(each)) for each in (pairs.sampled, pairs.pair, pairs.sampled))
        if len(pairs.sampled):
            apart_now(pairs.bodies, placed, pairs.bodies.met, apart)
            apart[apart <= TOUCH_M] = 0.0
            gaps_now(pairs, placed, gaps, least)
        return cls(whole, pairs, placed, Now(apart, gaps, least))

    def first(self, way: Way, length: float) -> Met | None:
        """Where two links first come so near that they may touch; None: nowhere.

        Exact to a millimetre for links that are apart now. Links that touch already may lie deeper in each other by as
        much as is in doubt about their depth, a centimetre or so.

        Args:
            way: where the motion leads.
            length: travel that is looked at.
        """
        if not self.pairs.sampled.size or length <= 0:
            return None
        rates = np.append(way.rates, 0.0)[self.machine.tree.column]
        rates[self.machine.tree.kind == FIXED] = 0.0
        moves_with = _moves_with(rates, self.machine.tree.parent)
        bodies = self.pairs.bodies
        moving = moves_with[bodies.one] != moves_with[bodies.other]
        if not moving.any():
            return None
        if way.stops is None:
            travel, pair, place = self._first(way, length, moving)
        else:
            looked_at = replace(way, length=length)
            travel, pair, place = first_stop_meeting(
                self.machine, self.pairs, self.now, looked_at, np.flatnonzero(moving)
            )
        if pair < 0:
            return None
        rows = sorted((bodies.one[pair], bodies.other[pair]), reverse=True)
        parent = self.machine.tree.parent
        rows.sort(key=lambda row: parent[row] < 0 or moves_with[row] == moves_with[0])
        one, other = (self.machine.link_names[row] for row in rows)
        return Met(float(travel), one, other, place)

    def _first(
        self, way: Way, length: float, moving: NDArray[np.bool_]
    ) -> tuple[float, int, NDArray[np.float64]]:
        """As `first_meeting`; `moving`: the pairs whose links move against each other, shape (pairs,)."""
        machine, pairs, skin = self.machine, self.pairs, self.pairs.skin
        speeds = cluster_speeds(machine, skin, self.world_from_link, way)
        by_link = np.zeros(len(machine.links))
        np.maximum.at(by_link, skin.link, speeds)
        closing = (speeds[pairs.cluster] + by_link[pairs.other][pairs.pair]) * moving[pairs.pair]
        mover = Mover(machine.tree, machine.world_from_base, skin, way.course, closing)
        by_part = cluster_speeds(machine, parts_of(machine.shape), self.world_from_link, way)
        parts = Travelling(machine.tree, machine.world_from_base, way.course, by_part)
        steps = Steps(STEP_IN_COVERS * skin.cover, TOGETHER)
        found: tuple[float, int, NDArray[np.float64]] = first_meeting(
            mover, parts, pairs, length, self.now, steps
        )
        return found


def _moves_with(rates: NDArray[np.float64], parent: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each link the first up the tree that it moves as one with.

    Args:
        rates: of the joint above each link, 0 where it does not move, shape (n_links,).
        parent: of each link, -1 for none, shape (n_links,).
    """
    moves_with = np.arange(rates.size)
    for row, above in enumerate(parent):
        if above >= 0 and rates[row] == 0.0:
            moves_with[row] = moves_with[above]
    return moves_with
