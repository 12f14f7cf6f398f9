"""Poses drawn from the limits of joints."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.joint import Joint

REACH = np.pi
"""Of a joint without end, so much to both sides of zero: one turn, or a bounded way [rad or m]."""
LONG_M = 100.0
"""A joint that slides over more than this is taken for one without end [m]."""


def is_bounded(joint: Joint) -> bool:
    """Whether both limits of a joint are such that poses are drawn between them."""
    span = joint.upper - joint.lower
    return bool(np.isfinite(span) and (joint.unit == "rad" or span <= LONG_M))


def drawn_between(joint: Joint) -> tuple[float, float]:
    """Between which positions poses are drawn [m or rad]: the joint's limits.

    Of one that turns without end it is one turn, of one that slides without end 2 pi m about zero, or on from the limit
    that is nearest to zero.
    """
    if is_bounded(joint):
        return joint.lower, joint.upper
    zero = min(max(0.0, joint.lower), joint.upper)
    upper = min(joint.upper, max(joint.lower, zero - REACH) + 2 * REACH)
    return max(joint.lower, upper - 2 * REACH), upper


def random_poses(joints: Sequence[Joint], count: int, seed: int = 0) -> NDArray[np.float64]:
    """Poses drawn from the joints' limits (`drawn_between`), shape (count, n_joints).

    Args:
        joints: those that are commanded.
        count: how many.
        seed: of the draw.
    """
    ends = np.array([drawn_between(joint) for joint in joints]).reshape(-1, 2)
    return np.random.default_rng(seed).uniform(ends[:, 0], ends[:, 1], (count, len(joints)))
