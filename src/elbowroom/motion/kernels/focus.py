"""Which blocks of voxels spheres pass on straight ways: arrays in, arrays out."""

import math

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.rigid import along


@njit(cache=True, nogil=True)
def mark_ways(world_from_links, balls, before, low, edge, near):
    """Marks the blocks that the boxes about balls meet, each on its way from one place to the next.

    Args:
        world_from_links: at each place, (places, links, 4, 4).
        balls: link, centre and radius of each (`machine.kernels.body.Clusters`).
        before: for each place, the place from which a body comes there, (places,).
        low, edge: the grid's least corner (3,) and the edge of a block [m].
        near: (x, y, z) bool, blocks, written.
    """
    first, last = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for place in range(before.size):
        for n in range(balls.link.size):
            to, since = world_from_links[place, balls.link[n]], world_from_links[before[place], balls.link[n]]
            x, y, z, r = balls.centre[n, 0], balls.centre[n, 1], balls.centre[n, 2], balls.radius[n]
            for axis in range(3):
                a, b = along(to, axis, x, y, z), along(since, axis, x, y, z)
                first[axis] = max(math.floor((min(a, b) - r - low[axis]) / edge), 0)
                last[axis] = min(math.floor((max(a, b) + r - low[axis]) / edge), near.shape[axis] - 1)
            for i in range(first[0], last[0] + 1):
                for j in range(first[1], last[1] + 1):
                    for k in range(first[2], last[2] + 1):
                        near[i, j, k] = True
