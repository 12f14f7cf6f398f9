"""Which blocks of voxels spheres pass on straight ways: arrays in, arrays out."""

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def mark_ways(world_from_link, link, centre, radius, before, low, edge, near):
    """Marks the blocks that the boxes about spheres meet, each on its way from one place to the next.

    Args:
        world_from_link: at each place, (places, links, 4, 4).
        link, centre, radius: of each sphere its link, its middle in that link's frame and its radius, (n,), (n, 3),
            (n,) [m].
        before: for each place, the place from which a body comes there, (places,).
        low, edge: the grid's least corner (3,) and the edge of a block [m].
        near: (x, y, z) bool, blocks, written.
    """
    first, last = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for place in range(before.size):
        to, since = world_from_link[place], world_from_link[before[place]]
        for n in range(link.size):
            l, x, y, z = link[n], centre[n, 0], centre[n, 1], centre[n, 2]  # noqa: E741
            for axis in range(3):
                a = to[l, axis, 0] * x + to[l, axis, 1] * y + to[l, axis, 2] * z + to[l, axis, 3]
                b = since[l, axis, 0] * x + since[l, axis, 1] * y + since[l, axis, 2] * z + since[l, axis, 3]
                first[axis] = max(math.floor((min(a, b) - radius[n] - low[axis]) / edge), 0)
                last[axis] = min(math.floor((max(a, b) + radius[n] - low[axis]) / edge), near.shape[axis] - 1)
            for i in range(first[0], last[0] + 1):
                for j in range(first[1], last[1] + 1):
                    for k in range(first[2], last[2] + 1):
                        near[i, j, k] = True
