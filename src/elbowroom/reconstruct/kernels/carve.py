"""Coarse to fine over cubes of 16 voxels, blocks of 4 and single voxels: what all cameras say, as bit planes.

Early-out (`complete` False): a voxel that three cameras see through is done, and no plane but ONE, TWO and THREE says
anything of it, so that neither the order nor the grouping of cameras can be read off the result.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_count, lowest_bit, uncounted
from elbowroom.reconstruct.kernels.aged import still_through
from elbowroom.reconstruct.kernels.box import ALL, LANES
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.grown import GROWN, look_grown
from elbowroom.reconstruct.kernels.look import Look, ask, contested, measured_at_centre, sort_out
from elbowroom.reconstruct.kernels.outline import OUTLINES, settle_block
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

FEW = 5
"""So many cameras are asked pixel by pixel before the next are asked at all."""


class Scratch(NamedTuple):
    """Memory of one kernel.

    lanes (1,): a record of `kernels.box`, voxel (1,): one of `kernels.cone`, outlines (1,): one of `kernels.outline`,
    grown (1,): one of `kernels.grown`; in arrays, or nothing would hold their memory. order (n,): in which cameras are
    asked of a cube. By camera of a cube: through, mixed (n,): blocks that it sees through, and those that must be asked
    voxel by voxel; past (n,): blocks that it saw through when it was exposed, of which it is asked whether that still
    holds; gone (n,): blocks of which it surely sees through nothing any more; undecided (n,): blocks with voxels left
    for the pixel test; unsettled, stopped (n, 64): which voxels, and which of these it surely does not see through;
    ageing (n, 64): voxels of which it must be asked whether it still sees through them.
    """

    lanes: np.ndarray
    voxel: np.ndarray
    outlines: np.ndarray
    grown: np.ndarray
    order: np.ndarray
    through: np.ndarray
    mixed: np.ndarray
    past: np.ndarray
    gone: np.ndarray
    undecided: np.ndarray
    unsettled: np.ndarray
    stopped: np.ndarray
    ageing: np.ndarray


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
        np.empty(1, OUTLINES),
        np.empty(1, GROWN),
        np.empty(cameras, dtype=np.int64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
    )
    is_aged = views.cameras[views.order[-1]].aged_m > 0.0 if cameras else False
    for number in cubes:
        cube = cube_at(lattice, number)
        _ask_blocks(cube, views, answers, scratch)
        _put_in_order(views.order, scratch.through, scratch.order)
        # the best cameras by windows and pixels first, then the next: where three see through, others need not be
        # asked; at last all of them of what they do not see through, where there is no surface yet
        for first, last, is_last in (
            (0, FEW, False),
            (FEW, 2 * FEW, False),
            (2 * FEW, cameras, False),
            (0, cameras, True),
        ):
            some = scratch.order[first:last]
            # camera by camera, so that the part of its image that the cube covers stays in the cache
            for c in some[:0] if is_last else some:
                _ask_voxels(cube, c, views, answers, scratch)
            # those that saw through, if they still do, then those that may
            for turn in range(2, 3) if is_last else range(0 if is_aged else 1, 2):
                for c in some:
                    _ask_pixels(cube, c, turn, views, answers, scratch)
        for word in range(cube.word, cube.word + 64):
            if not answers.complete:
                make_canonical(answers.planes, word)
            for plane in range(PLANES):
                answers.planes[plane, word] &= answers.asked[word]


@uncounted(cache=True)
def _put_in_order(order, through, best_first):
    """Which cameras are asked of a cube first: those that see through the most of its blocks, which leaves the fewest
    voxels to the others, and the same bits.

    Args:
        order: of all cubes; it decides among those that see through as many.
        through: by camera, the blocks that it sees through.
        best_first: written.
    """
    for n in range(order.size):
        c, at = order[n], n
        many = bit_count(through[c])
        while at > 0 and bit_count(through[best_first[at - 1]]) < many:
            best_first[at] = best_first[at - 1]
            at -= 1
        best_first[at] = c


@uncounted(cache=True, forceinline=True)
def _ask_blocks(cube, views, answers, scratch):
    """Asks all cameras of the 64 blocks of a cube, and counts who sees through."""
    through, mixed = scratch.through, scratch.mixed
    blocks, asked = blocks_of(cube), NOTHING
    for lane in range(64):
        if answers.asked[cube.word + lane]:
            asked |= np.uint64(1) << np.uint64(lane)
    # not a literal: numba would compile all that `ask` calls once more
    keep_partly = np.bool_(True)
    for c in range(through.size):
        scratch.past[c] = scratch.gone[c] = NOTHING
        look = ask(views.cameras[c], views.windows, blocks, keep_partly, scratch.lanes[0])
        through[c], mixed[c] = look.through, look.unsure
        if views.cameras[c].aged_m > 0.0:
            then, still = look.through, NOTHING
            if answers.fine[cube.word]:
                still, scratch.gone[c] = look_grown(
                    views.cameras[c], views.texels, asked & (then | look.unsure), blocks, scratch.grown[0]
                )
            elif then:
                still = ask(views.aged[c], views.windows, blocks, keep_partly, scratch.lanes[0]).through
            through[c], mixed[c], scratch.past[c] = still, look.unsure & ~still, then & ~still
    while asked:
        lane = lowest_bit(asked)
        here = np.uint64(1) << np.uint64(lane)
        asked &= ~here
        for c in range(through.size):
            if through[c] & here:
                note_through(answers, cube.word + lane, ALL)


@uncounted(cache=True, forceinline=True)
def _ask_voxels(cube, c, views, answers, scratch):
    """Asks one camera of the voxels of those blocks that it neither sees through nor says nothing of."""
    camera = views.cameras[c]
    is_aged = camera.aged_m > 0.0
    blocks, undecided = scratch.mixed[c] | scratch.past[c], NOTHING
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
        scratch.unsettled[c, lane] = scratch.stopped[c, lane] = scratch.ageing[c, lane] = NOTHING
        through = open_voxels
        if scratch.mixed[c] & here:
            through = _look(cube, (c, lane), open_voxels, views, answers, scratch)
        if is_aged:
            through = _still(cube, (c, lane), through, views, answers, scratch)
        note_through(answers, word, through)
        if scratch.unsettled[c, lane] | scratch.ageing[c, lane]:
            undecided |= here
    scratch.undecided[c] = undecided


@uncounted(cache=True, forceinline=True)
def _look(cube, at, open_voxels, views, answers, scratch):
    """Of the voxels of a block that are asked those that a camera sees through by its windows; notes what it disputes.

    Where the pixel test decides, `scratch.unsettled` says of which voxels it is to be asked.
    """
    c, lane = at
    camera, word = views.cameras[c], cube.word + lane
    look = ask(camera, views.windows, voxels_of(cube, lane), answers.fine[word], scratch.lanes[0])
    unsure = look.unsure & open_voxels
    if unsure:
        if camera.blank:
            note_disputed(answers, word, unsure, NOTHING, unsure)
        elif answers.fine[word]:
            surface, stopped = NOTHING, NOTHING
            if not look.partly:
                surface, stopped = sort_out(camera, views.texels, cube.edge, unsure, scratch.lanes[0])
                note_disputed(answers, word, surface, surface, NOTHING)
            scratch.stopped[c, lane] = stopped
            scratch.unsettled[c, lane] = unsure & ~surface
        else:
            left = Look(look.through, unsure, look.partly, look.reach)
            _dispute(camera, word, left, views.texels, answers, scratch.lanes[0])
    return look.through & open_voxels


@uncounted(cache=True, forceinline=True)
def _still(cube, at, through, views, answers, scratch):
    """Of voxels that a camera saw through those of which that surely holds, whatever has moved since.

    Where the pixel test decides, `scratch.ageing` says of which others it is to be asked. Of voxels that were unsettled
    and are neither, it is only asked any more what the camera disputes.
    """
    c, lane = at
    word, unsettled = cube.word + lane, scratch.unsettled[c, lane]
    maybe = through | (unsettled & ~scratch.stopped[c, lane])
    if not maybe:
        return NOTHING
    if not answers.fine[word]:
        look = ask(views.aged[c], views.windows, voxels_of(cube, lane), answers.fine[word], scratch.lanes[0])
        return look.through & maybe
    still, gone = NOTHING, ALL
    if not (scratch.gone[c] >> np.uint64(lane)) & np.uint64(1):
        boxes = voxels_of(cube, lane)
        still, gone = look_grown(views.cameras[c], views.texels, maybe, boxes, scratch.grown[0])
    left = maybe & ~(still | gone)
    scratch.ageing[c, lane] = left
    scratch.unsettled[c, lane] = unsettled & ~still
    scratch.stopped[c, lane] |= ~left
    return still & maybe


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


@uncounted(cache=True, forceinline=True)
def _ask_pixels(cube, c, turn, views, answers, scratch):
    """Asks one camera pixel by pixel of voxels left to that.

    In turn 0 those that it saw through, in turn 1 those that it may see through, then others.
    """
    planes, camera = answers.planes, views.cameras[c]
    blocks = scratch.undecided[c]
    while blocks:
        lane = lowest_bit(blocks)
        blocks &= ~(np.uint64(1) << np.uint64(lane))
        word = cube.word + lane
        stopped = scratch.stopped[c, lane]
        rest = (
            scratch.ageing[c, lane]
            if turn == 0
            else scratch.unsettled[c, lane] & (~stopped if turn == 1 else stopped)
        )
        if not answers.complete:
            rest &= ~planes[THREE, word]
            if turn == 2:
                rest &= ~planes[SURFACE, word]
        if not rest:
            continue
        boxes, seen = voxels_of(cube, lane), rest
        if turn > 0:
            memory = scratch.outlines[0], scratch.voxel[0]
            # who is counted has to say all; else a surface disputes already
            in_surface = NOTHING if answers.complete else rest & planes[SURFACE, word]
            seen, disputed, surface, blind = settle_block(
                camera, views.texels, (rest, in_surface), turn == 2, boxes, memory
            )
            note_disputed(answers, word, disputed, surface, blind)
        if camera.aged_m > 0.0:
            # of others it is known that what was seen through does not count
            seen = NOTHING
            if turn == 0:
                seen = still_through(camera, views.texels, rest, boxes, scratch.voxel[0])
            scratch.unsettled[c, lane] &= ~seen
            scratch.stopped[c, lane] |= rest
        note_through(answers, word, seen)
