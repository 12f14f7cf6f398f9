"""What a camera's view tells of its motion, where it does not tell all: before two walls nothing shows up and down."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.shift import STEADY_COVARIANCE, STEADY_MOVE_M, Shift
from elbowroom.monitor.health.drift.tolerance import Tolerance

SHARE = 1 / 3
"""Of a knock such a view shows a part, so that less of it is called moved: this share of the tolerance."""
STEADY_PER_M = 0.001
"""Steady error of the move per metre to what is in view, at most that of any view."""
DRIFT_PER_M = 0.002
"""A sensor that warms up changes its depths by so much per metre [m]: never less is called moved."""


@dataclass(frozen=True, slots=True, eq=False)
class ShownPart:
    """The directions of motion, of turn and move together, that a view does not show; and what is called moved in it.

    Args:
        across: shape (k, 6): takes a motion [rad, m] to its parts in the k hidden directions, in tolerances.
        names: of the motions about and along the camera's axes that the view does not show.
        tolerance: smaller than that of a view that shows all.
        steady: covariance of what is steady in the reference, shape (6, 6) [rad, m].
    """

    across: NDArray[np.float64]
    names: tuple[str, ...]
    tolerance: Tolerance
    steady: NDArray[np.float64]

    @classmethod
    def of(cls, reference: CameraReference, tolerance: Tolerance) -> "ShownPart | None":
        """What is hidden in a reference's view; None: it shows all motions.

        Args:
            reference: of the camera.
            tolerance: of views that show all.
        """
        names = reference.unseen_motions(tolerance.turn_rad, tolerance.move_m)
        if not names:
            return None
        scale = np.array([tolerance.turn_rad] * 3 + [tolerance.move_m] * 3)
        variances, directions = np.linalg.eigh(reference.covariance() / np.outer(scale, scale))
        across = directions[:, variances > 1 / 9].T / scale
        range_m = float(np.median(reference.points_in_camera[:, 2]))
        move_m = min(max(SHARE * tolerance.move_m, DRIFT_PER_M * range_m), tolerance.move_m)
        smaller = Tolerance(tolerance.turn_rad * move_m / tolerance.move_m, move_m)
        steady = STEADY_COVARIANCE * min(1.0, STEADY_PER_M * range_m / STEADY_MOVE_M) ** 2
        return cls(across, names, smaller, steady)

    def shift(self, motion: NDArray[np.float64], covariance: NDArray[np.float64]) -> Shift:
        """The part of a fitted motion that the view shows: the motion if there was none in the hidden directions.

        Noise in normals makes hidden directions look as if they were shown a little, and what is fitted there wanders
        by centimetres; conditioned on nothing there, the rest is as sure as it looks.

        Args:
            motion: turn [rad], move [m], shape (6,).
            covariance: of it, shape (6, 6).
        """
        gain = covariance @ self.across.T @ np.linalg.inv(self.across @ covariance @ self.across.T)
        left = covariance - gain @ self.across @ covariance
        return Shift.of(motion - gain @ (self.across @ motion), (left + left.T) / 2, self.steady, self.names)
