"""People on their rounds who do not walk into the machine, nor into each other: they wait, and turn back in the end."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from elbowroom.evaluate.lag.near import LinkBoxes
from elbowroom.evaluate.rooms.exact import ExactTravel
from elbowroom.machine import Machine
from elbowroom.simulate.person import Person, Stance

SPARE_M = 0.03
"""Nearer than this nobody goes to a machine [m]."""
ROOM_M = 0.7
"""Nor, middle to middle, to somebody else [m]."""
PATIENCE_S = (1.0, 3.0)
"""After standing for about so long people go back the way they came [s]."""


@dataclass(slots=True, eq=False)
class People:
    """Where everybody is.

    Args:
        staff: who walks.
        machine: that they walk past.
        rng: says how patient they are.
    """

    staff: Sequence[Person]
    machine: Machine
    rng: np.random.Generator
    _boxes: LinkBoxes = field(init=False)
    _clock_s: list[float] = field(init=False)
    _way: list[int] = field(init=False)
    _waits_s: list[float] = field(init=False)

    def __post_init__(self) -> None:
        self._boxes = LinkBoxes.of(self.machine)
        self._clock_s = [0.0] * len(self.staff)
        self._way = [1] * len(self.staff)
        self._waits_s = [float(self.rng.uniform(*PATIENCE_S)) for _ in self.staff]

    @property
    def stances(self) -> list[Stance]:
        """In the order of the staff."""
        return [person.walk.at(clock) for person, clock in zip(self.staff, self._clock_s, strict=True)]

    def step(self, joints: Mapping[str, float], step_s: float) -> None:
        """Everybody goes on, if there is room.

        Args:
            joints: where the machine is, by name [m or rad].
            step_s: for how long [s].
        """
        for number, person in enumerate(self.staff):
            clock = self._clock_s[number] + self._way[number] * step_s
            if self._is_free(number, person.walk.at(clock), joints):
                self._clock_s[number] = clock
                continue
            self._waits_s[number] -= step_s
            if self._waits_s[number] < 0:
                self._way[number] = -self._way[number]
                self._waits_s[number] = float(self.rng.uniform(*PATIENCE_S))

    def _is_free(self, number: int, stance: Stance, joints: Mapping[str, float]) -> bool:
        here = self.staff[number].walk.at(self._clock_s[number])
        for other, person in enumerate(self.staff):
            if other == number:
                continue
            there = person.walk.at(self._clock_s[other])
            away = _apart(stance, there)
            if away < ROOM_M and away < _apart(here, there):
                return False
        body = self._boxes.may_be_near(joints, list(self.staff[number].solids(stance)[:1]), SPARE_M)
        return not body or ExactTravel(self.machine, body).gap(joints, SPARE_M) >= SPARE_M


def _apart(one: Stance, other: Stance) -> float:
    return float(np.hypot(one.x_m - other.x_m, one.y_m - other.y_m))
