"""What is blocked within a body where it stands: points against voxels."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, word_of
from elbowroom.motion.kernels.mover import carried
from elbowroom.motion.kernels.touched import SURFACE, kind_of
from elbowroom.motion.kernels.volume import counted


@njit(cache=True, nogil=True)
def blocked_inside(points, link, world_from_link, volume, found, places):
    """For each link, the most cautious block that a point within it lies in.

    Args:
        points, link: within the solid, (n, 3) in the link's frame, and the link's row, (n,).
        world_from_link: (links, 4, 4).
        volume: what is blocked.
        found: (links,) int64, `NOTHING` on entry: what the block is.
        places: (links, 3), written where there is one: the voxel's centre [m].
    """
    lattice = volume.lattice
    edge = lattice.edge
    for n in range(link.size):
        row = link[n]
        if found[row] == SURFACE:
            continue
        x, y, z = carried(world_from_link[row], points[n])
        u, v, w, _ = counted(x, y, z, 0.0, lattice)
        # what is not a number lies nowhere; what lies outside is the surface's matter
        if not (0.0 <= u < lattice.nx and 0.0 <= v < lattice.ny and 0.0 <= w < lattice.nz):
            continue
        i, j, k = int(u), int(v), int(w)
        word, bit = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z), bit_of(i, j, k)
        if not volume.words[word] & bit:
            continue
        kind = kind_of(volume, word, bit)
        if kind < found[row]:
            found[row] = kind
            places[row, 0] = lattice.x0 + (i + 0.5) * edge
            places[row, 1] = lattice.y0 + (j + 0.5) * edge
            places[row, 2] = lattice.z0 + (k + 0.5) * edge
