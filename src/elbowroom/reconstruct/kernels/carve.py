"""Coarse to fine over cubes of 16 voxels, blocks of 4 and single voxels: what all cameras say, as bit planes.

Early-out (`complete` False): a voxel that three cameras see through is done, and no plane but ONE, TWO and THREE says
anything of it, so that neither the order nor the grouping of cameras can be read off the result.
"""

from typing import NamedTuple

import numpy as np
from numba import njit
from numba.cpython.unsafe.numbers import trailing_zeros

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.reconstruct.kernels.box import ALL, BLANK, FLOATS, INTS, SPLIT
from elbowroom.reconstruct.kernels.look import ask, contested, measured_at_centre, sort_out
from elbowroom.reconstruct.kernels.pixel import PIXEL_FLOATS, settle_word
from elbowroom.reconstruct.kernels.planes import (
    BLIND,
    DISPUTED,
    NOTHING,
    PLANES,
    SURFACE,
    THREE,
    count_through,
    make_canonical,
    tally,
)


class Said(NamedTuple):
    """What is asked, and where the answers go; of all words at once, each kernel writes those of its own cubes.

    inside (words,) uint64: the voxels that are asked. fine (words,) bool: blocks that get the pixel test where windows
    do not settle them. complete: whether all cameras are asked of every voxel, and counted. planes (PLANES, words)
    uint64, zeros on entry. through_count, dispute_count: (words, 64) uint8 where complete, else of no size.
    """

    inside: np.ndarray
    fine: np.ndarray
    complete: bool
    planes: np.ndarray
    through_count: np.ndarray
    dispute_count: np.ndarray


class Scratch(NamedTuple):
    """Memory of one kernel.

    floats, ints, flags and its view as words: of `kernels.box`; pixel: of `kernels.pixel`. By camera of a cube:
    through, mixed (n,): blocks that it sees through, and those that must be asked voxel by voxel; undecided (n,):
    blocks with voxels left for the pixel test; unsettled, stopped (n, 64): which voxels, and which of these it surely
    does not see through.
    """

    floats: np.ndarray
    ints: np.ndarray
    flags: np.ndarray
    flag_words: np.ndarray
    pixel: np.ndarray
    through: np.ndarray
    mixed: np.ndarray
    undecided: np.ndarray
    unsettled: np.ndarray
    stopped: np.ndarray


@njit(cache=True, nogil=True)
def carve_cubes(cubes, lattice, inside, views, fine, complete, planes, through_count, dispute_count):
    """Carves some 16-voxel cubes; each writes only its own 64 words.

    Args:
        cubes: (n,) indices of cubes.
        lattice: the grid.
        views: all cameras.
        inside, fine, complete, planes, through_count, dispute_count: see `Said`.
    """
    cameras = views.numbers.shape[0]
    flags = np.empty(192, dtype=np.uint8)
    scratch = Scratch(
        np.empty(FLOATS, dtype=np.float32),
        np.empty(INTS, dtype=np.int32),
        flags,
        flags.view(np.uint64),
        np.empty(PIXEL_FLOATS, dtype=np.float64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty(cameras, dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
        np.empty((cameras, 64), dtype=np.uint64),
    )
    said = Said(inside, fine, complete, planes, through_count, dispute_count)
    edge = lattice.edge
    for cube in cubes:
        x = lattice.x0 + (cube // (lattice.cubes_y * lattice.cubes_z)) * 16 * edge
        y = lattice.y0 + ((cube // lattice.cubes_z) % lattice.cubes_y) * 16 * edge
        z = lattice.z0 + (cube % lattice.cubes_z) * 16 * edge
        _ask_blocks(cube, x, y, z, edge, views, said, scratch)
        # camera by camera, so that the part of its image that the cube covers stays in the cache
        for c in range(cameras):
            _ask_voxels(cube, c, x, y, z, edge, views, said, scratch)
        # first those that may see through: where three do, the others need not be asked, nor where there is a surface
        for turn in range(2):
            for c in range(cameras):
                _ask_pixels(cube, c, turn, x, y, z, edge, views, said, scratch)
        for word in range(cube * 64, cube * 64 + 64):
            if not complete:
                make_canonical(planes, word)
            for plane in range(PLANES):
                planes[plane, word] &= inside[word]


@uncounted(cache=True)
def _ask_blocks(cube, x, y, z, edge, views, said, scratch):
    """Asks all cameras of the 64 blocks of a cube whose least corner is (x, y, z), and counts who sees through."""
    floats, ints, flags, flag_words = scratch.floats, scratch.ints, scratch.flags, scratch.flag_words
    through, mixed, inside, planes = scratch.through, scratch.mixed, said.inside, said.planes
    block = 4.0 * edge
    # not literals: numba would compile all that `ask` calls once for each of them
    of_blocks, keep = np.int64(1), np.bool_(True)
    for c in range(through.size):
        through[c], mixed[c], _, _ = ask(
            views.numbers, views.levels, views.offset, views.windows, c, of_blocks,
            x + 0.5 * block, y + 0.5 * block, z + 0.5 * block, block, keep, floats, ints, flags, flag_words,
        )  # fmt: skip
    for lane in range(64):
        word = cube * 64 + lane
        here = np.uint64(1) << np.uint64(lane)
        if not inside[word]:
            continue
        for c in range(through.size):
            if through[c] & here:
                count_through(planes, word, ALL)
                if said.complete:
                    tally(said.through_count, word, ALL)


@uncounted(cache=True)
def _ask_voxels(cube, c, x, y, z, edge, views, said, scratch):
    """Asks one camera of the voxels of those blocks that it neither sees through nor says nothing of."""
    numbers, levels, offset, windows = views.numbers, views.levels, views.offset, views.windows
    floats, ints, flags, flag_words = scratch.floats, scratch.ints, scratch.flags, scratch.flag_words
    inside, fine, complete, planes = said.inside, said.fine, said.complete, said.planes
    of_voxels = np.int64(0)
    blocks, undecided = scratch.mixed[c], NOTHING
    while blocks:
        lane = np.int64(trailing_zeros(blocks))
        here = np.uint64(1) << np.uint64(lane)
        blocks &= ~here
        word = cube * 64 + lane
        open_voxels = inside[word] if complete else inside[word] & ~planes[THREE, word]
        if not open_voxels:
            continue
        bx = x + ((lane >> 4) * 4 + 0.5) * edge
        by = y + (((lane >> 2) & 3) * 4 + 0.5) * edge
        bz = z + ((lane & 3) * 4 + 0.5) * edge
        seen, unsure, partly, reach = ask(
            numbers, levels, offset, windows, c, of_voxels, bx, by, bz, edge, fine[word],
            floats, ints, flags, flag_words,
        )  # fmt: skip
        seen &= open_voxels
        unsure &= open_voxels
        count_through(planes, word, seen)
        if complete:
            tally(said.through_count, word, seen)
        if not unsure:
            continue
        if numbers[c, BLANK] != 0.0:
            planes[DISPUTED, word] |= unsure
            planes[BLIND, word] |= unsure
            if complete:
                tally(said.dispute_count, word, unsure)
        elif fine[word]:
            undecided |= here
            _sort_out(c, lane, word, unsure, partly, edge, views, said, scratch)
        else:
            _dispute(c, word, unsure, partly, reach, views, said, scratch)
    scratch.undecided[c] = undecided


@uncounted(cache=True)
def _sort_out(c, lane, word, unsure, partly, edge, views, said, scratch):
    """Leaves a block's unsure voxels to the pixel test, but those that one look at the middle pixel settles."""
    surface, stopped = NOTHING, NOTHING
    if not partly:
        surface, stopped = sort_out(
            views.numbers, c, edge, views.texel_first[c], views.trust_texels, views.doubt_texels,
            unsure, scratch.floats,
        )  # fmt: skip
        said.planes[DISPUTED, word] |= surface
        said.planes[SURFACE, word] |= surface
        if said.complete:
            tally(said.dispute_count, word, surface)
    scratch.stopped[c, lane] = stopped
    scratch.unsettled[c, lane] = unsure & ~surface


@uncounted(cache=True)
def _dispute(c, word, unsure, partly, reach, views, said, scratch):
    """Without the pixel test, a voxel that windows do not settle is disputed, if by pixels that are not explained."""
    planes, disputed = said.planes, unsure
    if views.numbers[c, SPLIT] != 0.0:
        # one dispute is enough, unless they are counted
        asked = unsure if said.complete else unsure & ~planes[DISPUTED, word]
        disputed = contested(
            views.numbers, c, views.tile_first[c], views.doubt_tiles, views.doubt_squares,
            asked, partly, reach, scratch.floats,
        )  # fmt: skip
    surface, blind = measured_at_centre(
        views.numbers, c, views.texel_first[c], views.doubt_texels, views.tile_first[c], views.doubt_tiles,
        unsure, planes[SURFACE, word], partly, scratch.floats, scratch.ints, scratch.flags, scratch.flag_words,
    )  # fmt: skip
    planes[DISPUTED, word] |= disputed
    planes[SURFACE, word] |= surface
    planes[BLIND, word] |= blind
    if said.complete:
        tally(said.dispute_count, word, disputed)


@uncounted(cache=True)
def _ask_pixels(cube, c, turn, x, y, z, edge, views, said, scratch):
    """Asks one camera pixel by pixel of voxels left to that: in turn 0 those it may see through, then others."""
    complete, planes = said.complete, said.planes
    blocks = scratch.undecided[c]
    while blocks:
        lane = np.int64(trailing_zeros(blocks))
        blocks &= ~(np.uint64(1) << np.uint64(lane))
        word = cube * 64 + lane
        stopped = scratch.stopped[c, lane]
        rest = scratch.unsettled[c, lane] & (~stopped if turn == 0 else stopped)
        if not complete:
            rest &= ~planes[THREE, word]
            if turn == 1:
                rest &= ~planes[SURFACE, word]
        if not rest:
            continue
        seen, disputed, surface, blind = settle_word(
            views.numbers, c, views.trust_texels, views.doubt_texels, views.texel_first[c],
            views.trust_tiles, views.doubt_tiles, views.tile_first[c], rest,
            x + ((lane >> 4) * 4 + 0.5) * edge,
            y + (((lane >> 2) & 3) * 4 + 0.5) * edge,
            z + ((lane & 3) * 4 + 0.5) * edge,
            edge, scratch.pixel,
        )  # fmt: skip
        planes[SURFACE, word] |= surface
        planes[BLIND, word] |= blind
        planes[DISPUTED, word] |= disputed
        count_through(planes, word, seen)
        if complete:
            tally(said.through_count, word, seen)
            tally(said.dispute_count, word, disputed)
