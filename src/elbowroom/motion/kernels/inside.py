"""What is blocked within a body where it stands: points against voxels."""

from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, word_of
from elbowroom.motion.kernels.mover import ROUNDING_M, carried
from elbowroom.motion.kernels.shared import row_of
from elbowroom.motion.kernels.touched import SURFACE, kind_of
from elbowroom.motion.kernels.volume import counted, meets_block


@njit(cache=True, nogil=True)
def blocked_inside(deep, links, world_from_link, volume, found, places):
    """For each link, the most cautious block that a point within it lies in.

    Args:
        deep: points within the solid, in clusters (`machine.kernels.body.Clusters`).
        links: whether to look at each link, (links,).
        world_from_link: (links, 4, 4).
        volume: what is blocked.
        found: (links,) int64, `NOTHING` on entry: what the block is.
        places: (links, 3), written where there is one: the voxel's centre [m].
    """
    for cluster in range(deep.link.size):
        row = deep.link[cluster]
        if not links[row] or found[row] == SURFACE:
            continue
        x, y, z = carried(world_from_link[row], deep.centre[cluster])
        r = deep.radius[cluster] + ROUNDING_M
        if meets_block(volume.words, volume.cubes, volume.lattice, x, y, z, r):
            _look_at_points(deep, cluster, world_from_link[row], volume, found, places)


@njit
def _look_at_points(deep, cluster, world_from_link, volume, found, places):
    """The same for the points of one cluster."""
    lattice, row = volume.lattice, deep.link[cluster]
    for n in range(deep.start[cluster], deep.stop[cluster]):
        x, y, z = carried(world_from_link, deep.points[n])
        u, v, w, _ = counted(x, y, z, 0.0, lattice)
        # what is not a number lies nowhere; what lies outside is the surface's matter
        if not (0.0 <= u < lattice.nx and 0.0 <= v < lattice.ny and 0.0 <= w < lattice.nz):
            continue
        i, j, k = int(u), int(v), int(w)
        word, bit = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z), bit_of(i, j, k)
        if not volume.words[word] & bit:
            continue
        # of a voxel that the link only reaches into, what it does not cover blocks
        shared = row_of(volume.shared, (i * lattice.ny + j) * lattice.nz + k)
        if shared >= 0 and volume.shared.links[shared, row]:
            continue
        kind = kind_of(volume, word, bit)
        if kind < found[row]:
            found[row] = kind
            places[row, 0] = lattice.x0 + (i + 0.5) * lattice.edge
            places[row, 1] = lattice.y0 + (j + 0.5) * lattice.edge
            places[row, 2] = lattice.z0 + (k + 0.5) * lattice.edge
