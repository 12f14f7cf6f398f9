"""Coarse to fine over cubes of 16 voxels, blocks of 4 and single voxels: what all cameras say, as bit planes.

Early-out (`complete` False): a voxel that three cameras see through is done, and no plane but ONE, TWO and THREE says
anything of it, so that neither the order nor the grouping of cameras can be read off the result.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
from elbowroom.reconstruct.kernels.box import ALL, LANES
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.look import Look, ask, contested, measured_at_centre, sort_out
from elbowroom.reconstruct.kernels.pixel import settle_word
from elbowroom.reconstruct.kernels.place import blocks_of, cube_at, voxels_of
from elbowroom.reconstruct.kernels.planes import (
    DISPUTED,
    NOTHING,
    PLANES,
    SURFACE,
    THREE,
    make_canonical,
    note_disputed,
    note_through,
)


class Scratch(NamedTuple):
    """Memory of one kernel.

    lanes (1,): a record of `kernels.box`, voxel (1,): one of `kernels.cone`; in arrays, or nothing would hold their
    memory. By camera of a cube: through, mixed (n,): blocks that it sees through, and those that must be asked voxel by
    voxel; undecided (n,): blocks with voxels left for the pixel test; unsettled, stopped (n, 64): which voxels, and
    which of these it surely does not see through.
    """

    lanes: np.ndarray
    voxel: np.ndarray
    through: np.ndarray
    mixed: np.ndarray
    undecided: np.ndarray
    unsettled: np.ndarray
    stopped: np.ndarray


@njit(cache=True, nogil=True)
def carve_cubes(cubes, lattice, views, answers):
    """Carves some 16-voxel cubes; each writes only its own 64 words.

    Args:
        cubes: (n,) indices of cubes.
        lattice: the grid.
        views: all cameras.
        answers: what is asked of them, and where the answers go.
    """
    cameras = views.cameras.size
    scratch = Scratch(
        np.empty(1, LANES),
        np.empty(1, VOXEL),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
    )
    for number in cubes:
        cube = cube_at(lattice, number)
        _ask_blocks(cube, views, answers, scratch)
        # camera by camera, so that the part of its image that the cube covers stays in the cache
        for c in range(cameras):
            _ask_voxels(cube, c, views, answers, scratch)
        # first those that may see through: where three do, the others need not be asked, nor where there is a surface
        for turn in range(2):
            for c in range(cameras):
                _ask_pixels(cube, c, turn, views, answers, scratch)
        for word in range(cube.word, cube.word + 64):
            if not answers.complete:
                make_canonical(answers.planes, word)
            for plane in range(PLANES):
                answers.planes[plane, word] &= answers.asked[word]


@uncounted(cache=True)
def _ask_blocks(cube, views, answers, scratch):
    """Asks all cameras of the 64 blocks of a cube, and counts who sees through."""
    through, mixed = scratch.through, scratch.mixed
    blocks = blocks_of(cube)
    # not a literal: numba would compile all that `ask` calls once more
    keep_partly = np.bool_(True)
    for c in range(through.size):
        look = ask(views.cameras[c], views.windows, blocks, keep_partly, scratch.lanes[0])
        through[c], mixed[c] = look.through, look.unsure
    for lane in range(64):
        word = cube.word + lane
        here = np.uint64(1) << np.uint64(lane)
        if not answers.asked[word]:
            continue
        for c in range(through.size):
            if through[c] & here:
                note_through(answers, word, ALL)


@uncounted(cache=True)
def _ask_voxels(cube, c, views, answers, scratch):
    """Asks one camera of the voxels of those blocks that it neither sees through nor says nothing of."""
    camera = views.cameras[c]
    blocks, undecided = scratch.mixed[c], NOTHING
    while blocks:
        lane = lowest_bit(blocks)
        here = np.uint64(1) << np.uint64(lane)
        blocks &= ~here
        word = cube.word + lane
        open_voxels = answers.asked[word]
        if not answers.complete:
            open_voxels &= ~answers.planes[THREE, word]
        if not open_voxels:
            continue
        look = ask(camera, views.windows, voxels_of(cube, lane), answers.fine[word], scratch.lanes[0])
        note_through(answers, word, look.through & open_voxels)
        unsure = look.unsure & open_voxels
        if not unsure:
            continue
        if camera.blank:
            note_disputed(answers, word, unsure, NOTHING, unsure)
        elif answers.fine[word]:
            undecided |= here
            surface, stopped = NOTHING, NOTHING
            if not look.partly:
                surface, stopped = sort_out(camera, views.texels, cube.edge, unsure, scratch.lanes[0])
                note_disputed(answers, word, surface, surface, NOTHING)
            scratch.stopped[c, lane] = stopped
            scratch.unsettled[c, lane] = unsure & ~surface
        else:
            left = Look(look.through, unsure, look.partly, look.reach)
            _dispute(camera, word, left, views.texels, answers, scratch.lanes[0])
    scratch.undecided[c] = undecided


@uncounted(cache=True)
def _dispute(camera, word, look, texels, answers, lanes):
    """Without the pixel test, a voxel that windows do not settle is disputed, if by pixels that are not explained."""
    planes, disputed = answers.planes, look.unsure
    if camera.explained:
        # one dispute is enough, unless they are counted
        asked = disputed if answers.complete else disputed & ~planes[DISPUTED, word]
        disputed = contested(camera, texels, asked, look, lanes)
    surface, blind = measured_at_centre(camera, texels, look, planes[SURFACE, word], lanes)
    note_disputed(answers, word, disputed, surface, blind)


@uncounted(cache=True)
def _ask_pixels(cube, c, turn, views, answers, scratch):
    """Asks one camera pixel by pixel of voxels left to that: in turn 0 those it may see through, then others."""
    planes = answers.planes
    blocks = scratch.undecided[c]
    while blocks:
        lane = lowest_bit(blocks)
        blocks &= ~(np.uint64(1) << np.uint64(lane))
        word = cube.word + lane
        stopped = scratch.stopped[c, lane]
        rest = scratch.unsettled[c, lane] & (~stopped if turn == 0 else stopped)
        if not answers.complete:
            rest &= ~planes[THREE, word]
            if turn == 1:
                rest &= ~planes[SURFACE, word]
        if not rest:
            continue
        seen, disputed, surface, blind = settle_word(
            views.cameras[c], views.texels, rest, voxels_of(cube, lane), scratch.voxel[0]
        )
        note_disputed(answers, word, disputed, surface, blind)
        note_through(answers, word, seen)
