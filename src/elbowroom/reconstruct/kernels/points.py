"""The thesis' test of voxel centres (section 3.1), for comparison."""

import numpy as np
from numba import njit

from elbowroom.reconstruct.kernels.pixel import DISPUTES, IS_BLIND, IS_SURFACE, THROUGH, settle_centre
from elbowroom.reconstruct.kernels.planes import (
    BLIND,
    DISPUTED,
    NOTHING,
    SURFACE,
    count_through,
    make_canonical,
    tally,
)


@njit(cache=True, nogil=True)
def carve_points(cubes, lattice, inside, views, fine, complete, planes, through_count, dispute_count):
    """The thesis' test of centres, every voxel with every camera; arguments as of `kernels.carve.carve_cubes`."""
    numbers, texel_first, doubt_texels = views.numbers, views.texel_first, views.doubt_texels
    edge = lattice.edge
    for cube in cubes:
        x = lattice.x0 + (cube // (lattice.cubes_y * lattice.cubes_z)) * 16 * edge
        y = lattice.y0 + ((cube // lattice.cubes_z) % lattice.cubes_y) * 16 * edge
        z = lattice.z0 + (cube % lattice.cubes_z) * 16 * edge
        for word in range(cube * 64, cube * 64 + 64):
            if not inside[word]:
                continue
            lane = word & 63
            bx = x + ((lane >> 4) * 4 + 0.5) * edge
            by = y + (((lane >> 2) & 3) * 4 + 0.5) * edge
            bz = z + ((lane & 3) * 4 + 0.5) * edge
            for c in range(numbers.shape[0]):
                seen, disputed, surface, blind = NOTHING, NOTHING, NOTHING, NOTHING
                for voxel in range(64):
                    answer = settle_centre(
                        numbers,
                        c,
                        texel_first[c],
                        doubt_texels,
                        bx + (voxel >> 4) * edge,
                        by + ((voxel >> 2) & 3) * edge,
                        bz + (voxel & 3) * edge,
                        edge,
                    )
                    bit = (np.uint64(1) << np.uint64(voxel)) & inside[word]
                    seen |= bit if answer & THROUGH else NOTHING
                    disputed |= bit if answer & DISPUTES else NOTHING
                    surface |= bit if answer & IS_SURFACE else NOTHING
                    blind |= bit if answer & IS_BLIND else NOTHING
                count_through(planes, word, seen)
                planes[DISPUTED, word] |= disputed
                planes[SURFACE, word] |= surface
                planes[BLIND, word] |= blind
                if complete:
                    tally(through_count, word, seen)
                    tally(dispute_count, word, disputed)
            if not complete:
                make_canonical(planes, word)
