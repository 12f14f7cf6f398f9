"""How far joints still go after the command to stop, and how fast they may be for what room there is."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from elbowroom.errors import InputError


def braking_distance(speed: float, braking_time_s: float) -> float:
    """Distance of a braking at constant deceleration: v t / 2 (thesis 4.1: the distance S).

    Args:
        speed: of the joint [m/s or rad/s].
        braking_time_s: from full speed to rest [s].

    Returns:
        [m or rad along the joint].

    Raises:
        InputError: a speed or a time that is not a finite number above 0.
    """
    for name, value, unit in (("speed", speed, "m/s or rad/s"), ("braking_time_s", braking_time_s, "s")):
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"braking distance: {name} is {value}, must be a finite number above 0 [{unit}]")
    return float(speed) * float(braking_time_s) / 2


def safe_share(room: float, stopping_distance: float) -> float:
    """The greatest share of full speed from which a joint rests within some room: f D <= d, so f = d / D, 0 to 1.

    D is what it takes at full speed, reaction and braking, v T_r + v t / 2. From a share f it is f v T_r + f^2 v t / 2
    where t is braking alone; but t may hold a reaction time, whose way shrinks as the speed does and no faster, so f D
    bounds it from above (thesis 4.1, and docs/safety.md, "Greatest safe speed").

    Args:
        room: free travel less what shall be left of it; none below 0 [m or rad].
        stopping_distance: D, above 0 [the same unit].
    """
    return float(min(1.0, max(0.0, room) / stopping_distance))


@dataclass(frozen=True, slots=True, eq=False)
class Braking:
    """How a machine comes to rest once it is told to.

    Each joint goes on as it was for the reaction time, and is then at rest within its braking time, slowing down all
    the while. Braking times are the worst case: it may be at rest earlier.

    Args:
        speeds: full speed of each joint by name [m/s or rad/s].
        times_s: from full speed to rest, by name [s]; from less than full speed it may be as long, since the time may
            hold a reaction time.
        reaction_time_s: T_r, as far as `times_s` do not hold it [s].
        leaves_path: whether each joint may brake by itself, so that the machine leaves a path of several joints; False:
            whoever drives it promises that it brakes along the path.

    Raises:
        InputError: a speed or a time that is not a finite number above 0, a joint that has only one of both, a reaction
            time below 0.
    """

    speeds: Mapping[str, float]
    times_s: Mapping[str, float]
    reaction_time_s: float = 0.0
    leaves_path: bool = True

    def __post_init__(self) -> None:
        lonely = sorted(set(self.speeds) ^ set(self.times_s))
        if lonely:
            raise InputError(f"braking: {lonely[0]} needs a speed and a braking time, has one of both")
        for name in self.speeds:
            braking_distance(self.speeds[name], self.times_s[name])
        if not (np.isfinite(self.reaction_time_s) and self.reaction_time_s >= 0):
            raise InputError(f"braking: reaction_time_s is {self.reaction_time_s}, must be at least 0 [s]")
