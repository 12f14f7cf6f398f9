"""A small motion of a rigid thing, with its uncertainty."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

STEADY_TURN_RAD = 0.0009
STEADY_MOVE_M = 0.0015
"""No shift is known better than this, however many frames speak: what is steady in the reference stays in the mean. So
large that 95 % of the knocks of `elbowroom bench calibration --part drift` lie within two sigmas."""
STEADY_COVARIANCE = np.diag([STEADY_TURN_RAD**2] * 3 + [STEADY_MOVE_M**2] * 3)
LARGE_TURN_DEG, LARGE_MOVE_MM = 2.0, 60.0
"""Beyond this the surfaces about the spots are others than those that were commissioned: sizes are rough."""


@dataclass(frozen=True, slots=True, eq=False)
class Shift:
    """By how much something turned and moved, seen from itself.

    Args:
        turn_rad: rotation vector, shape (3,), its own axes [rad].
        move_m: shape (3,), its own axes [m].
        covariance: of both, shape (6, 6) [rad, m].
        not_shown: motions that the view does not show: it may have moved so, too.
    """

    turn_rad: NDArray[np.float64]
    move_m: NDArray[np.float64]
    covariance: NDArray[np.float64]
    not_shown: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        motion: NDArray[np.float64],
        covariance: NDArray[np.float64],
        steady: NDArray[np.float64] = STEADY_COVARIANCE,
        not_shown: tuple[str, ...] = (),
    ) -> "Shift":
        """From the six numbers of the kernels, copied; never surer than what is steady in the reference.

        Args:
            motion: turn [rad], move [m], shape (6,).
            covariance: of it, shape (6, 6).
            steady: what is added to that.
            not_shown: as of the class.
        """
        return cls(motion[:3].copy(), motion[3:].copy(), covariance + steady, not_shown)

    @property
    def turn_deg(self) -> float:
        """Angle of the turn [deg]."""
        return float(np.degrees(np.linalg.norm(self.turn_rad)))

    @property
    def move_mm(self) -> float:
        """Length of the move [mm]."""
        return float(np.linalg.norm(self.move_m) * 1e3)

    @property
    def turn_sigma_deg(self) -> float:
        """Standard deviation along the turn's own axis [deg]."""
        return float(np.degrees(_along(self.turn_rad, self.covariance[:3, :3])))

    @property
    def move_sigma_mm(self) -> float:
        """Standard deviation along the move's own direction [mm]."""
        return float(_along(self.move_m, self.covariance[3:, 3:]) * 1e3)

    def exceeds(self, turn_rad: float, move_m: float, sigmas: float) -> bool:
        """Whether it is larger than a tolerance in turn or in move, by so many sigmas.

        Args:
            turn_rad, move_m: the tolerance.
            sigmas: of the uncertainty along the shift.
        """
        turn = np.linalg.norm(self.turn_rad) - sigmas * _along(self.turn_rad, self.covariance[:3, :3])
        move = np.linalg.norm(self.move_m) - sigmas * _along(self.move_m, self.covariance[3:, 3:])
        return bool(turn > turn_rad or move > move_m)

    def words(self, turn_rad: float, move_m: float) -> str:
        """What is worth saying: "turned by 0.90 ± 0.05 degrees and moved by 12 ± 2 mm", two sigmas.

        Args:
            turn_rad, move_m: a part is left out that is below half of this, unless both are.
        """
        if self.turn_deg > LARGE_TURN_DEG or self.move_mm > LARGE_MOVE_MM:
            turn, move = (
                f"turned by about {self.turn_deg:.0f} degrees",
                f"moved by about {self.move_mm:.0f} mm",
            )
        else:
            turn = f"turned by {self.turn_deg:.2f} ± {2 * self.turn_sigma_deg:.2f} degrees"
            move = f"moved by {self.move_mm:.0f} ± {2 * self.move_sigma_mm:.0f} mm"
        turn_is_large = bool(np.linalg.norm(self.turn_rad) > turn_rad / 2)
        move_is_large = bool(np.linalg.norm(self.move_m) > move_m / 2)
        said = f"{turn} and {move}" if turn_is_large == move_is_large else turn if turn_is_large else move
        if not self.not_shown:
            return said
        return f"{said}, which may be a part of it: its view does not show {', '.join(self.not_shown)}"


def _along(vector: NDArray[np.float64], covariance: NDArray[np.float64]) -> float:
    length = float(np.linalg.norm(vector))
    if length < 1e-12:
        return float(np.linalg.norm(covariance, 2)) ** 0.5
    unit = vector / length
    return max(float(unit @ covariance @ unit), 0.0) ** 0.5
