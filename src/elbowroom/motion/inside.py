"""What is blocked within the machine's body where it stands: something else is there, a hand in a model's excess.

A body meets what comes into it with its surface. What lies in it from the start it would meet only where it leaves it.
"""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine, body_samples
from elbowroom.machine.kernels.body import Clusters
from elbowroom.motion.ground import Ground
from elbowroom.motion.kernels.inside import blocked_inside
from elbowroom.motion.kernels.touched import NOTHING
from elbowroom.motion.sweep import Block

CLUSTER_IN_VOXELS = 2.5
"""Points are asked together that lie in a box of this edge."""


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
        found = np.full(len(machine.links), NOTHING, dtype=np.int64)
        places = np.zeros((len(machine.links), 3))
        deep = _deep(machine.anywhere, ground.space.grid.voxel_size_m)
        blocked_inside(deep, ground.links, world_from_link, ground.volume, found, places)
        for row in np.flatnonzero(found != NOTHING):
            blocks[int(row)] = Block(0.0, int(found[row]), -1, places[row])
    return blocks


@kept
def _deep(machine: Machine, voxel_size_m: float) -> Clusters:
    """Points in the checked links, no nearer than half a voxel to a sample of the surface: none lies outside."""
    from scipy.spatial import KDTree  # slow to load, and done once a machine

    samples = body_samples(machine, voxel_size_m)
    points, links = [np.zeros((0, 3), dtype=np.float32)], [np.zeros(0, dtype=np.int32)]
    for row in np.unique(samples.interior_link):
        within = samples.interior[samples.interior_link == row]
        away, _ = KDTree(samples.points[samples.point_link == row]).query(within)
        points.append(within[away > 2 * samples.cover_m])
        links.append(np.full(len(points[-1]), row, dtype=np.int32))
    return _clustered(np.concatenate(points), np.concatenate(links), CLUSTER_IN_VOXELS * voxel_size_m)


def _clustered(points: NDArray[np.float32], link: NDArray[np.int32], edge: float) -> Clusters:
    """The points of links in clusters, each in a box of an edge [m]."""
    box = np.column_stack([link, np.floor(points / edge).astype(np.int64)])
    order = np.lexsort(box.T)
    points, link, box = points[order], link[order], box[order]
    start = np.flatnonzero(np.append(True, (box[1:] != box[:-1]).any(axis=1))[: len(box)])
    stop = np.append(start[1:], len(points))[: len(start)]
    centre = (box[start, 1:] + 0.5) * edge
    return Clusters(points, start, stop, link[start], centre, np.full(len(start), np.sqrt(0.75) * edge))
