"""The swept volume of a motion, as points: where its links come on the way that is free."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine

STOPS = 7
"""At so many places along its way the machine is looked at."""
CELL_M = 0.06
"""One point of each cell of this size is drawn [m]."""
STILL_M = 0.004
"""What moves less than this does not move [m]."""
MOST_POINTS = 2500


def way_points(
    machine: Machine,
    points: Mapping[str, NDArray[np.float64]],
    joints: Mapping[str, float],
    motion: tuple[str, float],
) -> NDArray[np.float64]:
    """Where the links that a motion moves come, shape (n, 3), world frame [m].

    Args:
        machine: what moves.
        points: of `bodies.link_points`.
        joints: where it stands, by name [m or rad].
        motion: joint, and how far and in which direction it goes [m or rad].
    """
    joint, travel = motion
    if abs(travel) < 1e-9:
        return np.zeros((0, 3))
    shares = np.linspace(1 / STOPS, 1.0, STOPS)
    return swept_points(
        machine, points, joints, [_held(machine, joints, joint, share * travel) for share in shares]
    )


def swept_points(
    machine: Machine,
    points: Mapping[str, NDArray[np.float64]],
    joints: Mapping[str, float],
    places: Sequence[Mapping[str, float]],
) -> NDArray[np.float64]:
    """Where the links come that are elsewhere at some of the places, shape (n, 3), world frame [m].

    Args:
        machine: what moves.
        points: of `bodies.link_points`.
        joints: where it stands, by name [m or rad].
        places: where it comes, likewise.
    """
    swept, before = [], machine.world_from_links(joints)
    for place in places:
        poses = machine.world_from_links(place)
        for name, own in points.items():
            placed = own @ poses[name][:3, :3].T + poses[name][:3, 3]
            start = own @ before[name][:3, :3].T + before[name][:3, 3]
            swept.append(placed[np.linalg.norm(placed - start, axis=1) > STILL_M])
    every = np.concatenate([np.zeros((0, 3)), *swept])
    cells = np.floor(every / CELL_M).astype(np.int64)
    every = every[np.unique(cells, axis=0, return_index=True)[1]]
    return every if len(every) <= MOST_POINTS else every[np.arange(MOST_POINTS) * len(every) // MOST_POINTS]


def _held(machine: Machine, joints: Mapping[str, float], joint: str, by: float) -> dict[str, float]:
    """Positions after one joint went on, within its limits."""
    moved = dict(joints)
    of = machine.joint(joint)
    moved[joint] = float(np.clip(joints[joint] + by, of.lower, of.upper))
    return moved
