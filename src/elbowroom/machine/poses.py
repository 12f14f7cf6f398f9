"""Poses drawn from the limits of joints."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.joint import Joint


def random_poses(joints: Sequence[Joint], count: int, seed: int = 0) -> NDArray[np.float64]:
    """Poses drawn from the joints' limits, shape (count, n_joints); of joints without end, one turn.

    Args:
        joints: those that are commanded.
        count: how many.
        seed: of the draw.
    """
    lower = np.array([max(joint.lower, -np.pi) for joint in joints])
    upper = np.array([min(joint.upper, np.pi) for joint in joints])
    return np.random.default_rng(seed).uniform(lower, upper, (count, len(joints)))
