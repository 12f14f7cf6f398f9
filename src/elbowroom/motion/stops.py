"""Where a machine comes to rest whose joints brake each by itself: a box of joint positions for each moment."""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.motion.braking import Braking
from elbowroom.motion.kernels.beside import Box
from elbowroom.motion.path_way import PathWay

PIECES_A_STOP = 8
"""So many looks, at first, at what is commanded within the shortest braking time."""
Found = TypeVar("Found")


@dataclass(frozen=True, slots=True, eq=False)
class Stops:
    """The stops from a path. Times count from its beginning.

    Args:
        way: the path.
        goes_on_s: that joints still follow the path after the command [s].
        half_times_s: of each joint half of its braking time, 0 for those that do not move, shape (joints,) [s].
        lower, upper: where joints end at the latest, shape (joints,) [m or rad].
    """

    way: PathWay
    goes_on_s: float
    half_times_s: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]

    @classmethod
    def of(cls, machine: Machine, way: PathWay, braking: Braking) -> Self:
        """The stops from a path of a machine.

        Args:
            machine: whose joints they are.
            way: the path.
            braking: how joints come to rest.
        """
        joints = [machine.joint(name) for name in machine.joint_names]
        low, high = way.positions.min(axis=0), way.positions.max(axis=0)
        moving = low < high
        half = [
            braking.times_s[j.name] / 2 if moves else 0.0 for j, moves in zip(joints, moving, strict=True)
        ]
        return cls(
            way,
            braking.reaction_time_s,
            np.array(half),
            np.minimum([joint.lower for joint in joints], low),
            np.maximum([joint.upper for joint in joints], high),
        )

    def box(self, begin_s: float, end_s: float) -> Box:
        """All joint positions of stops that are commanded between two times, at rest and on the way there.

        Args:
            begin_s, end_s: since the path's beginning [s].
        """
        times = self.way.times_s - self.way.begin_s
        low, high = self._range(times, begin_s + self.goes_on_s, end_s + self.goes_on_s)
        back, forth = np.zeros_like(low), np.zeros_like(high)
        for half in np.unique(self.half_times_s[self.half_times_s > 0]):
            slowest, fastest = self._speeds(times, begin_s + self.goes_on_s, end_s + self.goes_on_s + half)
            own = self.half_times_s == half
            back[own], forth[own] = (slowest * half)[own], (fastest * half)[own]
        low, high = np.maximum(low + back, self.lower), np.minimum(high + forth, self.upper)
        return Box((low + high) / 2, (high - low) / 2)

    def _range(
        self, times: NDArray[np.float64], begin_s: float, end_s: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The least and greatest positions of a part of the path."""
        first, last = np.searchsorted(times, [begin_s, end_s], side="left")
        last = int(np.searchsorted(times, end_s, side="right"))
        ends = [_at(times, self.way.positions, time_s) for time_s in (begin_s, end_s)]
        rows = np.concatenate([self.way.positions[first:last], ends])
        return rows.min(axis=0), rows.max(axis=0)

    def _speeds(
        self, times: NDArray[np.float64], begin_s: float, end_s: float
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The least and greatest speeds of a part of the path, of none that lies beyond zero less than that."""
        first = max(int(np.searchsorted(times, begin_s, side="right")) - 1, 0)
        last = int(np.searchsorted(times, end_s, side="left"))
        steps = np.diff(times[first : last + 1])
        ways = np.diff(self.way.positions[first : last + 1], axis=0)[steps > 0]
        speeds = ways / steps[steps > 0, None]
        return speeds.min(axis=0, initial=0.0), speeds.max(axis=0, initial=0.0)

    def first(
        self,
        length: float,
        finest_s: float,
        look: Callable[[float, float], Found | None],
        begin: Callable[[float, float], None] | None = None,
    ) -> tuple[float, Found] | None:
        """The first moment of the path from which a stop is not free, and what was found there; None: all are.

        Args:
            length: so far is looked [s].
            finest_s: the moment is found to within this [s].
            look: says what is found of the stops commanded between two times; None: they are free.
            begin: is told before looks at several pieces of the path from when to when they are; None: nobody is.
        """
        pieces = list(self._pieces(length))
        for first in range(0, len(pieces), PIECES_A_STOP):
            together = pieces[first : first + PIECES_A_STOP]
            if begin is not None:
                begin(together[0][0], together[-1][1])
            for begin_s, end_s in together:
                found = _first(begin_s, end_s, finest_s, look)
                if found is not None:
                    return found
        return None

    def _pieces(self, length: float) -> Iterator[tuple[float, float]]:
        moving = self.half_times_s[self.half_times_s > 0]
        if not len(moving):
            return
        count = int(np.ceil(length / (2 * moving.min()) * PIECES_A_STOP))
        times = np.linspace(0.0, length, max(count, 1) + 1).tolist()
        yield from itertools.pairwise(times)


def _first(
    begin_s: float, end_s: float, finest_s: float, look: Callable[[float, float], Found | None]
) -> tuple[float, Found] | None:
    found = look(begin_s, end_s)
    if found is None:
        return None
    if end_s - begin_s <= finest_s:
        return begin_s, found
    middle_s = (begin_s + end_s) / 2
    return _first(begin_s, middle_s, finest_s, look) or _first(middle_s, end_s, finest_s, look)


def _at(times: NDArray[np.float64], rows: NDArray[np.float64], time_s: float) -> NDArray[np.float64]:
    """Between rows of rising times, straight; the later one where two are at one time."""
    after = int(np.searchsorted(times, time_s, side="right"))
    if after in (0, len(times)):
        return rows[min(after, len(times) - 1)]
    share = (time_s - times[after - 1]) / (times[after] - times[after - 1])
    found: NDArray[np.float64] = rows[after - 1] + share * (rows[after] - rows[after - 1])
    return found
