"""How much must speak for a small motion that fits what is seen, so that it is believed."""

from elbowroom.monitor.health.drift.kernels.watch import Fit

TURN_PRIOR_RAD, MOVE_PRIOR_M = 0.1, 0.2
"""Sigmas of a motion before anything was seen [rad], [m]: what nothing shows stays at zero."""
FOR_OVER_AGAINST = 5.0
"""What speaks for a motion must outweigh so much what stands where it was: a table that is pushed moves no wall."""
LEAST_FOR = 20.0
LEAST_FIT = 0.5
"""So much of what is in view must fit the motion."""


def convinces(fit: Fit) -> bool:
    """Whether so much speaks for a motion that it is believed, however large it is."""
    outweighs = fit.speaks_for > max(FOR_OVER_AGAINST * fit.against, LEAST_FOR)
    return bool(outweighs and fit.fits_moved >= LEAST_FIT)
