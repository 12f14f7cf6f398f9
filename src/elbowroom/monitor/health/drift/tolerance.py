"""What is not yet called moved."""

from dataclasses import dataclass

import numpy as np

from elbowroom.errors import InputError


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What is not yet called moved; the margin has to cover it.

    Args:
        turn_rad: [rad].
        move_m: [m].

    Raises:
        InputError: not above zero.
    """

    turn_rad: float = float(np.radians(0.4))
    move_m: float = 0.008

    def __post_init__(self) -> None:
        for name in ("turn_rad", "move_m"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise InputError(f"watch: {name} is {value}, must be above 0")
