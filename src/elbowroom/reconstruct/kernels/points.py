"""The thesis' test of voxel centres (section 3.1), for comparison."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.geometry.kernels.pinhole import pixel_of
from elbowroom.geometry.kernels.rigid import moved
from elbowroom.reconstruct.kernels.aged import still_through
from elbowroom.reconstruct.kernels.box import PLANE_EPS
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.pixel import DISPUTES, IS_BLIND, IS_SURFACE, THROUGH
from elbowroom.reconstruct.kernels.place import box_in, cube_at, voxels_of
from elbowroom.reconstruct.kernels.planes import NOTHING, make_canonical, note_disputed, note_through
from elbowroom.reconstruct.kernels.texels import NEUTRAL, NO_RETURN, greatest_of


@njit(cache=True, nogil=True)
def carve_points(cubes, lattice, views, answers):
    """The thesis' test of centres, every voxel with every camera; arguments as of `kernels.carve.carve_cubes`."""
    scratch = np.empty(1, VOXEL)
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
                if views.cameras[c].aged_m > 0.0:
                    seen = still_through(views.cameras[c], views.texels, seen, boxes, scratch[0])
                note_through(answers, word, seen)
                note_disputed(answers, word, disputed, surface, blind)
            if not answers.complete:
                make_canonical(answers.planes, word)


@uncounted(cache=True)
def _settle_centres(camera, doubt_texels, voxels, boxes):
    """What a camera says of the set voxels of a block: words (through, disputed, surface, blind)."""
    seen, disputed, surface, blind = NOTHING, NOTHING, NOTHING, NOTHING
    for lane in range(64):
        answer = _settle_centre(camera, doubt_texels, box_in(boxes, lane))
        bit = (np.uint64(1) << np.uint64(lane)) & voxels
        seen |= bit if answer & THROUGH else NOTHING
        disputed |= bit if answer & DISPUTES else NOTHING
        surface |= bit if answer & IS_SURFACE else NOTHING
        blind |= bit if answer & IS_BLIND else NOTHING
    return seen, disputed, surface, blind


@uncounted(cache=True, error_model="numpy")
def _settle_centre(camera, doubt_texels, box):
    """The thesis' depth test (section 3.1): the voxel's centre against the one pixel that it projects to."""
    px, py, pz = moved(camera.camera_from_world, box.x, box.y, box.z)
    if pz <= PLANE_EPS:
        return 0
    column, line = pixel_of(camera, px, py, pz)
    u, v = np.floor(column + 0.5), np.floor(line + 0.5)
    if not (u >= 0.0 and u < camera.width and v >= 0.0 and v < camera.height):
        return 0
    texel = doubt_texels[camera.first_texel + int(v) * camera.width + int(u)]
    if texel == NEUTRAL:
        return 0
    least, greatest = texel >> np.uint32(16), greatest_of(texel)
    if greatest == NO_RETURN:
        return DISPUTES | IS_BLIND
    at = np.sqrt(px * px + py * py + pz * pz) if camera.radial else pz
    margin, quantum = margin_at(camera.margin, at), camera.quantum
    # texels round by a quantum or two to the safe side; the plain comparison undoes that
    measured = (greatest - 1) * quantum
    if measured > at + margin and least * quantum + 4 * quantum > at + margin:
        return THROUGH
    if measured + margin >= at - 0.5 * box.edge:
        return DISPUTES | IS_SURFACE
    return 0
