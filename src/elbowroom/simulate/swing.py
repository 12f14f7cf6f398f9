"""A machine that swings about a pose, as slowly as its joints allow."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

from elbowroom.machine import Machine
from elbowroom.simulate.postures import Postures

AMPLITUDE = {"rad": 0.35, "m": 0.15}
"""How far a joint swings to each side, by its unit."""
USUAL_SPEED = {"rad": 0.35, "m": 0.15}
"""Of a joint of which no speed is known, by its unit [per second]."""
PERIODS_S = (8.0, 11.0, 7.0, 13.0, 9.0, 17.0)
"""Of one joint after the other, at least: so that no pose comes back soon."""
MOST_HALVINGS = 5
LOOKED_AT = 16
"""At so many moments it is asked whether the machine touches anything."""


@dataclass(frozen=True, slots=True, eq=False)
class Swing:
    """Where a machine is at each time; at time zero in the middle.

    Args:
        middle: by joint [m or rad].
        amplitude: how far each joint swings to both sides [m or rad]; all zero: it stands still.
        period_s: by joint [s].
    """

    middle: Mapping[str, float]
    amplitude: Mapping[str, float]
    period_s: Mapping[str, float]

    @classmethod
    def still(cls, joints: Mapping[str, float]) -> Self:
        """A machine that stands still."""
        return cls(dict(joints), dict.fromkeys(joints, 0.0), dict.fromkeys(joints, 1.0))

    @classmethod
    def about(cls, machine: Machine, middle: Mapping[str, float], speeds: Mapping[str, float]) -> Self:
        """A swing about a pose within the joints' limits and half their speeds.

        Args:
            machine: whose joints they are.
            middle: the pose, by joint [m or rad].
            speeds: full speeds by joint [m/s or rad/s]; one that is missing has a usual one.
        """
        amplitude, period_s = {}, {}
        for number, (name, value) in enumerate(middle.items()):
            joint = machine.joint(name)
            room = min(value - joint.lower, joint.upper - value)
            amplitude[name] = max(0.0, min(AMPLITUDE[joint.unit], room))
            slow = speeds.get(name, USUAL_SPEED[joint.unit]) / 2
            period_s[name] = max(PERIODS_S[number % len(PERIODS_S)], 2 * math.pi * amplitude[name] / slow)
        return cls(dict(middle), amplitude, period_s)

    def at(self, time_s: float) -> dict[str, float]:
        """Joint positions at a time since the start [m or rad]."""
        return {
            name: value + self.amplitude[name] * math.sin(2 * math.pi * time_s / self.period_s[name])
            for name, value in self.middle.items()
        }

    @property
    def is_still(self) -> bool:
        """Whether nothing moves."""
        return not any(self.amplitude.values())

    def clear_of(self, postures: Postures, times_s: Sequence[float]) -> Self:
        """The same swing, halved until it touches nothing at some times, at last none.

        Args:
            postures: of the machine in its room.
            times_s: since the start [s].
        """
        swing, some = self, list(times_s)[:: max(1, len(times_s) // LOOKED_AT)]
        for _ in range(MOST_HALVINGS):
            if swing.is_still or not any(postures.trouble(swing.at(time_s)) for time_s in some):
                return swing
            swing = replace(swing, amplitude={name: value / 2 for name, value in swing.amplitude.items()})
        return self.still(self.middle)
