"""What is blocked within the machine's body where it stands: something else is there, such as a hand in a model's excess.

A body meets what comes into it with its surface. What lies in it from the start it would meet only where it leaves it.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine, body_samples
from elbowroom.motion.ground import Ground
from elbowroom.motion.kernels.inside import blocked_inside
from elbowroom.motion.kernels.touched import NOTHING
from elbowroom.motion.sweep import Block


def blocks_inside(
    machine: Machine, grounds: tuple[Ground, ...], world_from_link: NDArray[np.float64]
) -> dict[int, Block]:
    """By link, the most cautious block that lies half a voxel or deeper in it; links without one are left out.

    Args:
        machine: the machine; unchecked links are left out.
        grounds: the space of each link.
        world_from_link: where they are, shape (n_links, 4, 4).
    """
    blocks = {}
    for ground in grounds:
        points, link = _deep(machine, ground.space.grid.voxel_size_m)
        own = ground.links[link]
        if not own.all():
            points, link = points[own], link[own]
        found = np.full(len(machine.links), NOTHING, dtype=np.int64)
        places = np.zeros((len(machine.links), 3))
        blocked_inside(points, link, world_from_link, ground.volume, found, places)
        for row in np.flatnonzero(found != NOTHING):
            blocks[int(row)] = Block(0.0, int(found[row]), -1, places[row])
    return blocks


@kept
def _deep(machine: Machine, voxel_size_m: float) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Points that lie in the checked links, and their links: such as are no nearer than half a voxel to a sample of the
    surface, so that none of them lies outside."""
    samples = body_samples(machine, voxel_size_m)
    keep = np.zeros(len(samples.interior), dtype=np.bool_)
    for row in np.unique(samples.interior_link):
        own = samples.interior_link == row
        away, _ = KDTree(samples.points[samples.point_link == row]).query(samples.interior[own])
        keep[own] = away > 2 * samples.cover_m
    return np.ascontiguousarray(samples.interior[keep]), np.ascontiguousarray(samples.interior_link[keep])
