"""Whether and when a machine meets itself on its way."""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.machine.kernels.body import FIXED
from elbowroom.motion.contacts import pairs_of
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.meeting import Pairs, Steps, first_meeting, gaps_now
from elbowroom.motion.sweep import cluster_speeds

STEP_IN_COVERS = 2.0
"""No step along a way is shorter than what moves links by this; in covering radii of their samples."""
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
        machine: the machine.
        pairs: of its links.
        world_from_link: where they are, shape (n_links, 4, 4).
        gaps, least: of `gaps_now`.
    """

    machine: Machine
    pairs: Pairs
    world_from_link: NDArray[np.float64]
    gaps: NDArray[np.float64]
    least: NDArray[np.float64]

    @classmethod
    def of(cls, machine: Machine, world_from_link: NDArray[np.float64]) -> Self:
        """At one place of the machine, whose links are there: shape (n_links, 4, 4)."""
        pairs = pairs_of(machine.anywhere)
        gaps, least = np.empty(len(pairs.pair)), np.empty(len(pairs.sampled))
        gaps_now(pairs, world_from_link, gaps, least)
        return cls(machine, pairs, world_from_link, gaps, least)

    def first(self, way: Way, length: float) -> Met | None:
        """Where two links first come so near that they may touch; None: nowhere.

        Links that are so near already may come nearer by as much as is in doubt about their distance, a centimetre
        or so.

        Args:
            way: where the motion leads.
            length: travel that is looked at.
        """
        if not self.pairs.sampled.size or length <= 0:
            return None
        speeds = cluster_speeds(self.machine, self.pairs.skin, self.world_from_link, way)
        by_link = np.zeros(len(self.machine.links))
        np.maximum.at(by_link, self.pairs.skin.link, speeds)
        travel, member, place = first_meeting(
            self.machine.tree,
            self.machine.world_from_base,
            self.pairs,
            way.course,
            length,
            self._closing(speeds, by_link, way),
            self.gaps,
            self.least,
            Steps(STEP_IN_COVERS * self.pairs.skin.cover, TOGETHER),
        )
        if member < 0:
            return None
        pair = self.pairs.pair[member]
        rows = sorted((self.pairs.sampled[pair], self.pairs.other[pair]), key=lambda row: -by_link[row])
        one, other = (self.machine.link_names[row] for row in rows)
        return Met(float(travel), one, other, place)

    def _closing(
        self, speeds: NDArray[np.float64], by_link: NDArray[np.float64], way: Way
    ) -> NDArray[np.float64]:
        """How fast the distance of each member of the pairs changes at most; 0 where both links move as one."""
        pairs, tree = self.pairs, self.machine.tree
        rates = np.append(way.rates, 0.0)[tree.column]
        rates[tree.kind == FIXED] = 0.0
        moves_with = np.arange(rates.size)
        for row, parent in enumerate(tree.parent):
            if parent >= 0 and rates[row] == 0.0:
                moves_with[row] = moves_with[parent]
        apart = moves_with[pairs.sampled] != moves_with[pairs.other]
        closing: NDArray[np.float64] = speeds[pairs.cluster] + by_link[pairs.other][pairs.pair]
        return closing * apart[pairs.pair]
