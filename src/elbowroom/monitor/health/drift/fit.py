"""The small motion that fits what is seen, and how much speaks for it."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.monitor.health.drift.kernels.watch import (
    AGAINST,
    FITS_MOVED,
    FITS_STILL,
    FOR,
    Fitted,
    Prior,
)

PRIOR = Prior(turn=0.1, move=0.2)
"""Sigmas of a motion before anything was seen [rad], [m]: what nothing shows stays at zero."""
FOR_OVER_AGAINST = 5.0
"""What speaks for a motion must outweigh so much what stands where it was: a table that is pushed moves no wall."""
LEAST_FOR = 20.0
LEAST_FIT = 0.5
"""So much of what is in view must fit the motion."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """What `fit_motion` found, by name.

    Args:
        motion: turn [rad], move [m], shape (6,).
        covariance: of it, shape (6, 6).
        speaks_for, against: log-likelihood of the motion over that of standing still, of the spots that speak for it,
            and of those that speak against it.
        fits_still, fits_moved: shares of the spots that fit without the motion and with it.
    """

    motion: NDArray[np.float64]
    covariance: NDArray[np.float64]
    speaks_for: float
    against: float
    fits_still: float
    fits_moved: float

    @classmethod
    def of(cls, fitted: Fitted) -> Self:
        """From what the kernel wrote."""
        motion, covariance, said = fitted
        return cls(
            motion,
            covariance,
            speaks_for=float(said[FOR]),
            against=float(said[AGAINST]),
            fits_still=float(said[FITS_STILL]),
            fits_moved=float(said[FITS_MOVED]),
        )

    @property
    def convinces(self) -> bool:
        """Whether so much speaks for the motion that it is believed, however large it is."""
        outweighs = self.speaks_for > max(FOR_OVER_AGAINST * self.against, LEAST_FOR)
        return outweighs and self.fits_moved >= LEAST_FIT


def unfitted() -> Fitted:
    """Room for what `fit_motion` writes."""
    return Fitted(np.empty(6), np.empty((6, 6)), np.empty(4))
