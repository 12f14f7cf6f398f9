"""Coarse to fine over cubes of 16 voxels, blocks of 4 and single voxels: what all cameras say, as bit planes.

Early-out (`complete` False): a voxel that three cameras see through is done, and no plane but ONE, TWO and THREE says
anything of it, so that neither the order nor the grouping of cameras can be read off the result.
"""

import numpy as np
from numba import njit
from numba.cpython.unsafe.numbers import trailing_zeros

from elbowroom.reconstruct._kernels_box import (
    ALL,
    BLANK,
    COSINE,
    CROSSING,
    FAR,
    FLOATS,
    GREATEST,
    HALF_EXTENT,
    INSIDE,
    INTS,
    NEAR,
    OUTSIDE,
    QUANTUM,
    RADIAL,
    SIZE,
    SPLIT,
    STATE,
    U,
    V,
    bound_inside,
    bound_partly,
    decide_inside,
    decide_partly,
    look_up,
    place_cube,
)
from elbowroom.reconstruct._kernels_pixel import (
    DISPUTES,
    IS_BLIND,
    IS_SURFACE,
    PIXEL_FLOATS,
    THROUGH,
    settle_centre,
    settle_word,
)
from elbowroom.reconstruct._kernels_pyramid import NEUTRAL, NO_RETURN, both_least

ONE, TWO, THREE, DISPUTED, SURFACE, BLIND = range(6)
PLANES = 6
NOTHING = np.uint64(0)
ROUNDING_M = 2e-5
"""More than float32 can err in the depth of a voxel [m]."""


@njit(cache=True, nogil=True, inline="always")
def _count_through(planes, word, mask):
    """Adds one camera's word to the planes *at least 1, 2, 3 cameras see through*."""
    planes[THREE, word] |= planes[TWO, word] & mask
    planes[TWO, word] |= planes[ONE, word] & mask
    planes[ONE, word] |= mask


@njit(cache=True, nogil=True)
def _tally(counts, word, mask):
    for lane in range(64):
        counts[word, lane] += np.uint8((mask >> np.uint64(lane)) & np.uint64(1))


@njit(cache=True, nogil=True, inline="always")
def _make_canonical(planes, word):
    """Where three see through, nothing else is said; where there is a surface, blindness is not."""
    open_voxels = ~planes[THREE, word]
    planes[DISPUTED, word] &= open_voxels
    planes[SURFACE, word] &= open_voxels
    planes[BLIND, word] &= open_voxels & ~planes[SURFACE, word]


@njit(cache=True, nogil=True)
def _measured_at_centre(numbers, c, first, doubt_texels, unsure, partly, floats):
    """Which unsure boxes hold the measured point of their centre's pixel, and which have pixels without a return."""
    surface, blind = NOTHING, NOTHING
    width = int(numbers[c, SIZE])
    quantum = numbers[c, QUANTUM]
    rest = unsure
    while rest:
        lane = np.int64(trailing_zeros(rest))
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        if partly and floats[STATE + lane] == CROSSING:
            continue
        if np.isinf(floats[GREATEST + lane]):
            blind |= bit
        texel = doubt_texels[first + int(floats[V + lane]) * width + int(floats[U + lane])]
        greatest = np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
        if texel == NEUTRAL or greatest == NO_RETURN:
            continue
        if floats[NEAR + lane] <= greatest * quantum <= floats[FAR + lane]:
            surface |= bit
    return surface, blind


@njit(cache=True, nogil=True)
def _sort_out(numbers, c, scale_edge, first, trust_texels, doubt_texels, unsure, floats):
    """What one look at the middle pixel settles of unsure voxels: words (surely a surface, surely not through).

    The ray through a voxel's centre lies in the cone of the pixel that the centre projects to, and runs inside the
    voxel for at least half an edge to both sides of it. So a return there makes the pixel test say *surface*, and one
    before the centre keeps it from saying *through*, whatever the other pixels hold. All voxels lie wholly in view.
    """
    surface, stopped = NOTHING, NOTHING
    width = int(numbers[c, SIZE])
    quantum = numbers[c, QUANTUM]
    radial = numbers[c, RADIAL] != 0.0
    extent = numbers[c, HALF_EXTENT + 3] if radial else numbers[c, HALF_EXTENT + 2]
    inner = 0.5 * scale_edge * (1.0 if radial else numbers[c, COSINE])
    rest = unsure
    while rest:
        lane = np.int64(trailing_zeros(rest))
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        at = 0.5 * (np.float64(floats[NEAR + lane]) + np.float64(floats[FAR + lane]))
        margin = (
            0.5 * (np.float64(floats[FAR + lane]) - np.float64(floats[NEAR + lane])) - extent - ROUNDING_M
        )
        pixel = first + int(floats[V + lane]) * width + int(floats[U + lane])
        if not (trust_texels[pixel] >> np.uint32(16)) * quantum < at + margin - ROUNDING_M:
            continue
        stopped |= bit
        texel = doubt_texels[pixel]
        greatest = np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
        if texel == NEUTRAL or greatest == NO_RETURN:
            continue
        if abs(greatest * quantum - at) < inner + margin - ROUNDING_M:
            surface |= bit
    return surface, stopped


@njit(cache=True, nogil=True)
def _contested(numbers, c, tile_first, doubt_tiles, unsure, partly, reach, floats):
    """Of the unsure boxes those that unexplained pixels dispute.

    Asked are all tiles that hold a pixel within `reach` of a box's centre pixel.
    """
    disputed = NOTHING
    width, height = int(numbers[c, SIZE]), int(numbers[c, SIZE + 1])
    across = (width + 3) >> 2
    quantum = np.float32(numbers[c, QUANTUM])
    rest = unsure
    while rest:
        lane = np.int64(trailing_zeros(rest))
        bit = np.uint64(1) << np.uint64(lane)
        rest &= ~bit
        if partly and floats[STATE + lane] == CROSSING:
            disputed |= bit
            continue
        u, v = int(floats[U + lane]), int(floats[V + lane])
        first, last = max(u - reach, 0) >> 2, min(u + reach, width - 1) >> 2
        both = NEUTRAL
        for row in range(max(v - reach, 0) >> 2, (min(v + reach, height - 1) >> 2) + 1):
            for tile in range(tile_first + row * across + first, tile_first + row * across + last + 1):
                both = both_least(both, doubt_tiles[tile])
        greatest = np.uint32(NO_RETURN) - (both & np.uint32(0xFFFF))
        past = np.float32(both >> np.uint32(16)) * quantum > floats[FAR + lane]
        hidden = greatest < NO_RETURN and np.float32(greatest) * quantum < floats[NEAR + lane]
        if not (past or hidden):
            disputed |= bit
    return disputed


@njit(cache=True, nogil=True)
def _ask(
    numbers, levels, offset, windows, c, scale, x, y, z, edge, keep_partly, floats, ints, flags, flag_words
):
    """Words (through, unsure) of the 64 children of a cube, whether the cube lies partly outside the image, and the
    children's reach in pixels."""
    px, py, pz, state = place_cube(numbers, c, scale, x, y, z, edge)
    if state == OUTSIDE:
        return NOTHING, NOTHING, False, 0
    if state == INSIDE:
        reach = bound_inside(numbers, levels, offset, c, scale, px, py, pz, floats, ints)
        look_up(windows, numbers[c, QUANTUM], floats, ints)
        through, unsure = decide_inside(floats, flags, flag_words)
        return through, unsure, False, reach
    reach = bound_partly(numbers, levels, offset, c, scale, px, py, pz, floats, ints)
    look_up(windows, numbers[c, QUANTUM], floats, ints)
    through, unsure, cut = decide_partly(floats, flags, flag_words)
    return through, (unsure | cut) if keep_partly else unsure, True, reach


@njit(cache=True, nogil=True)
def carve_cubes(cubes, lattice, inside, views, fine, complete, planes, through_count, dispute_count):
    """Carves some 16-voxel cubes; each writes only its own 64 words.

    Args:
        cubes: (n,) indices of cubes.
        lattice: the grid.
        inside: (words,) uint64, ones where the grid has voxels.
        views: all cameras.
        fine: (words,) bool, blocks that get the pixel test where windows do not settle them.
        complete: whether all cameras are asked of every voxel, and counted.
        planes: (PLANES, words) uint64, zeros on entry.
        through_count, dispute_count: (words, 64) uint8 where complete, else of no size.
    """
    # taken out of the tuple once: each look into it counts references, which costs more than the arithmetic below
    numbers, levels, offset = views.numbers, views.levels, views.offset
    windows, texel_first = views.windows, views.texel_first
    trust_texels, doubt_texels = views.trust_texels, views.doubt_texels
    tile_first, trust_tiles, doubt_tiles = views.tile_first, views.trust_tiles, views.doubt_tiles
    cameras = numbers.shape[0]
    floats = np.empty(FLOATS, dtype=np.float32)
    ints = np.empty(INTS, dtype=np.int32)
    flags = np.empty(192, dtype=np.uint8)
    flag_words = flags.view(np.uint64)
    scratch = np.empty(PIXEL_FLOATS, dtype=np.float64)
    through = np.empty(cameras, dtype=np.uint64)
    mixed = np.empty(cameras, dtype=np.uint64)
    undecided = np.empty(cameras, dtype=np.uint64)
    unsettled = np.empty((cameras, 64), dtype=np.uint64)
    stopped = np.empty((cameras, 64), dtype=np.uint64)
    edge = lattice.edge
    block = 4.0 * edge
    # not literals: numba would compile all that `_ask` calls once for each of them
    of_voxels, of_blocks, keep = np.int64(0), np.int64(1), np.bool_(True)
    for cube in cubes:
        x = lattice.x0 + (cube // (lattice.cubes_y * lattice.cubes_z)) * 16 * edge
        y = lattice.y0 + ((cube // lattice.cubes_z) % lattice.cubes_y) * 16 * edge
        z = lattice.z0 + (cube % lattice.cubes_z) * 16 * edge
        for c in range(cameras):
            through[c], mixed[c], _, _ = _ask(
                numbers,
                levels,
                offset,
                windows,
                c,
                of_blocks,
                x + 0.5 * block,
                y + 0.5 * block,
                z + 0.5 * block,
                block,
                keep,
                floats,
                ints,
                flags,
                flag_words,
            )
        for lane in range(64):
            word = cube * 64 + lane
            here = np.uint64(1) << np.uint64(lane)
            if not inside[word]:
                continue
            for c in range(cameras):
                if through[c] & here:
                    _count_through(planes, word, ALL)
                    if complete:
                        _tally(through_count, word, ALL)
        # camera by camera, so that the part of its image that the cube covers stays in the cache
        for c in range(cameras):
            blocks = mixed[c]
            undecided[c] = NOTHING
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
                seen, unsure, partly, reach = _ask(
                    numbers,
                    levels,
                    offset,
                    windows,
                    c,
                    of_voxels,
                    bx,
                    by,
                    bz,
                    edge,
                    fine[word],
                    floats,
                    ints,
                    flags,
                    flag_words,
                )
                seen &= open_voxels
                unsure &= open_voxels
                _count_through(planes, word, seen)
                if complete:
                    _tally(through_count, word, seen)
                if not unsure:
                    continue
                if numbers[c, BLANK] != 0.0:
                    planes[DISPUTED, word] |= unsure
                    planes[BLIND, word] |= unsure
                    if complete:
                        _tally(dispute_count, word, unsure)
                elif fine[word]:
                    surface, stopped[c, lane] = NOTHING, NOTHING
                    if not partly:
                        surface, stopped[c, lane] = _sort_out(
                            numbers, c, edge, texel_first[c], trust_texels, doubt_texels, unsure, floats
                        )
                        planes[DISPUTED, word] |= surface
                        planes[SURFACE, word] |= surface
                        if complete:
                            _tally(dispute_count, word, surface)
                    undecided[c] |= here
                    unsettled[c, lane] = unsure & ~surface
                else:
                    contested = unsure
                    if numbers[c, SPLIT] != 0.0:
                        # one dispute is enough, unless they are counted
                        open_voxels = unsure if complete else unsure & ~planes[DISPUTED, word]
                        contested = _contested(
                            numbers, c, tile_first[c], doubt_tiles, open_voxels, partly, reach, floats
                        )
                    surface, blind = _measured_at_centre(
                        numbers, c, texel_first[c], doubt_texels, unsure, partly, floats
                    )
                    planes[DISPUTED, word] |= contested
                    planes[SURFACE, word] |= surface
                    planes[BLIND, word] |= blind
                    if complete:
                        _tally(dispute_count, word, contested)
        # first those that may see through: where three do, the others need not be asked, nor where there is a surface
        for turn in range(2):
            for c in range(cameras):
                blocks = undecided[c]
                while blocks:
                    lane = np.int64(trailing_zeros(blocks))
                    blocks &= ~(np.uint64(1) << np.uint64(lane))
                    word = cube * 64 + lane
                    if turn == 0:
                        rest = unsettled[c, lane] & ~stopped[c, lane]
                    else:
                        rest = unsettled[c, lane] & stopped[c, lane]
                    if not complete:
                        rest &= ~planes[THREE, word]
                        if turn == 1:
                            rest &= ~planes[SURFACE, word]
                    if not rest:
                        continue
                    seen, disputed, surface, blind = settle_word(
                        numbers,
                        c,
                        trust_texels,
                        doubt_texels,
                        texel_first[c],
                        trust_tiles,
                        doubt_tiles,
                        tile_first[c],
                        rest,
                        x + ((lane >> 4) * 4 + 0.5) * edge,
                        y + (((lane >> 2) & 3) * 4 + 0.5) * edge,
                        z + ((lane & 3) * 4 + 0.5) * edge,
                        edge,
                        scratch,
                    )
                    planes[SURFACE, word] |= surface
                    planes[BLIND, word] |= blind
                    planes[DISPUTED, word] |= disputed
                    _count_through(planes, word, seen)
                    if complete:
                        _tally(through_count, word, seen)
                        _tally(dispute_count, word, disputed)
        for word in range(cube * 64, cube * 64 + 64):
            if not complete:
                _make_canonical(planes, word)
            for plane in range(PLANES):
                planes[plane, word] &= inside[word]


@njit(cache=True, nogil=True)
def carve_points(cubes, lattice, inside, views, fine, complete, planes, through_count, dispute_count):
    """The thesis' test of voxel centres, every voxel with every camera; arguments as of `carve_cubes`."""
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
                _count_through(planes, word, seen)
                planes[DISPUTED, word] |= disputed
                planes[SURFACE, word] |= surface
                planes[BLIND, word] |= blind
                if complete:
                    _tally(through_count, word, seen)
                    _tally(dispute_count, word, disputed)
            if not complete:
                _make_canonical(planes, word)
