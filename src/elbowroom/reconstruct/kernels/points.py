"""The thesis' test of voxel centres (section 3.1), for comparison."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.reconstruct.kernels.pixel import DISPUTES, IS_BLIND, IS_SURFACE, THROUGH, settle_centre
from elbowroom.reconstruct.kernels.place import box_in, cube_at, voxels_of
from elbowroom.reconstruct.kernels.planes import NOTHING, make_canonical, note_disputed, note_through


@njit(cache=True, nogil=True)
def carve_points(cubes, lattice, views, answers):
    """The thesis' test of centres, every voxel with every camera; arguments as of `kernels.carve.carve_cubes`."""
    for number in cubes:
        cube = cube_at(lattice, number)
        for lane in range(64):
            word = cube.word + lane
            if not answers.asked[word]:
                continue
            boxes = voxels_of(cube, lane)
            for c in range(views.cameras.size):
                seen, disputed, surface, blind = _settle_centres(
                    views.cameras[c], views.texels.doubt_texels, answers.asked[word], boxes
                )
                note_through(answers, word, seen)
                note_disputed(answers, word, disputed, surface, blind)
            if not answers.complete:
                make_canonical(answers.planes, word)


@uncounted(cache=True)
def _settle_centres(camera, doubt_texels, voxels, boxes):
    """What a camera says of the set voxels of a block: words (through, disputed, surface, blind)."""
    seen, disputed, surface, blind = NOTHING, NOTHING, NOTHING, NOTHING
    for lane in range(64):
        answer = settle_centre(camera, doubt_texels, box_in(boxes, lane))
        bit = (np.uint64(1) << np.uint64(lane)) & voxels
        seen |= bit if answer & THROUGH else NOTHING
        disputed |= bit if answer & DISPUTES else NOTHING
        surface |= bit if answer & IS_SURFACE else NOTHING
        blind |= bit if answer & IS_BLIND else NOTHING
    return seen, disputed, surface, blind
