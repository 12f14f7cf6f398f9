"""How far a joint still goes after the command to stop."""

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
