"""One look of a camera at the 64 children of a cube: through, unsure, and what is known of those that are unsure."""

import numpy as np
from numba.cpython.unsafe.numbers import trailing_zeros

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.reconstruct.kernels.box import (
    COSINE,
    CROSSING,
    FAR,
    GREATEST,
    HALF_EXTENT,
    INSIDE,
    LOW_GREATEST,
    LOW_LEAST,
    NEAR,
    OUTSIDE,
    QUANTUM,
    RADIAL,
    SIZE,
    STATE,
    TEXEL,
    U,
    V,
    bits_of,
    bound_inside,
    bound_partly,
    decide_inside,
    decide_partly,
    look_up,
    place_cube,
)
from elbowroom.reconstruct.kernels.planes import NOTHING
from elbowroom.reconstruct.kernels.pyramid import NEUTRAL, NO_RETURN, both_least

ROUNDING_M = 2e-5
"""More than float32 can err in the depth of a voxel [m]."""


@uncounted(cache=True)
def ask(
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


@uncounted(cache=True)
def _may_be_measured(numbers, c, tile_first, doubt_tiles, floats, ints, flags, flag_words):
    """The boxes between whose depth bounds something may be measured in the tile of their centre's pixel.

    Tiles stay in the cache, pixels do not: this saves most looks at single pixels.
    """
    across = (np.int32(numbers[c, SIZE]) + np.int32(3)) >> np.int32(2)
    tiles = doubt_tiles[tile_first:]
    for lane in range(64):
        row, column = np.int32(floats[V + lane]), np.int32(floats[U + lane])
        ints[TEXEL + lane] = (row >> np.int32(2)) * across + (column >> np.int32(2))
    for lane in range(64):
        tile = tiles[np.uint32(ints[TEXEL + lane])]
        ints[LOW_LEAST + lane] = np.int32(tile >> np.uint32(16))
        ints[LOW_GREATEST + lane] = np.int32(NO_RETURN) - np.int32(tile & np.uint32(0xFFFF))
    # a quantum is a power of two, so these products are exact
    quantum = np.float32(numbers[c, QUANTUM])
    for lane in range(64):
        least = np.float32(ints[LOW_LEAST + lane]) * quantum
        greatest = np.float32(ints[LOW_GREATEST + lane]) * quantum
        beyond_all = (greatest < floats[NEAR + lane]) & (ints[LOW_GREATEST + lane] != np.int32(NO_RETURN))
        flags[lane] = (not beyond_all) & (least <= floats[FAR + lane])
        flags[64 + lane] = floats[GREATEST + lane] == np.float32(np.inf)
        flags[128 + lane] = floats[STATE + lane] != CROSSING
    return bits_of(flag_words, 0), bits_of(flag_words, 1), bits_of(flag_words, 2)


@uncounted(cache=True)
def measured_at_centre(
    numbers,
    c,
    first,
    doubt_texels,
    tile_first,
    doubt_tiles,
    unsure,
    known,
    partly,
    floats,
    ints,
    flags,
    flag_words,
):
    """Which unsure boxes hold the measured point of their centre's pixel, and which have pixels without a return.

    Of `known` boxes it need not be told whether they are a surface.
    """
    surface = NOTHING
    width = int(numbers[c, SIZE])
    quantum = numbers[c, QUANTUM]
    rest, lost, in_front = _may_be_measured(
        numbers, c, tile_first, doubt_tiles, floats, ints, flags, flag_words
    )
    if partly:
        unsure &= in_front
    rest &= unsure & ~known
    # without branches, so that the looks of many lanes are under way at once
    while rest:
        lane = np.int64(trailing_zeros(rest))
        rest &= rest - np.uint64(1)
        texel = doubt_texels[first + int(floats[V + lane]) * width + int(floats[U + lane])]
        greatest = np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
        depth = greatest * quantum
        holds = (floats[NEAR + lane] <= depth) & (depth <= floats[FAR + lane])
        holds &= (texel != NEUTRAL) & (greatest != np.uint32(NO_RETURN))
        surface |= np.uint64(holds) << np.uint64(lane)
    return surface, lost & unsure


@uncounted(cache=True)
def sort_out(numbers, c, scale_edge, first, trust_texels, doubt_texels, unsure, floats):
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


@uncounted(cache=True)
def contested(numbers, c, tile_first, doubt_tiles, doubt_squares, unsure, partly, reach, floats):
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
        top, bottom = max(v - reach, 0) >> 2, min(v + reach, height - 1) >> 2
        both = least_of_tiles(doubt_tiles, doubt_squares, tile_first, across, top, bottom, first, last)
        greatest = np.uint32(NO_RETURN) - (both & np.uint32(0xFFFF))
        past = np.float32(both >> np.uint32(16)) * quantum > floats[FAR + lane]
        hidden = greatest < NO_RETURN and np.float32(greatest) * quantum < floats[NEAR + lane]
        if not (past or hidden):
            disputed |= bit
    return disputed


@uncounted(cache=True)
def least_of_tiles(tiles, squares, tile_first, across, top, bottom, first, last):
    """The least of a rectangle of tiles: of the squares that cover it, which may overlap."""
    both = NEUTRAL
    narrow = min(bottom - top, last - first) + 1
    level = (narrow >= 2) + (narrow >= 4) + (narrow >= 8)
    edge = 1 << level
    row = top
    while row <= bottom:
        begin = tile_first + min(row, bottom - edge + 1) * across
        column = first
        while column <= last:
            tile = begin + min(column, last - edge + 1)
            both = both_least(both, squares[level - 1, tile] if level else tiles[tile])
            column += edge
        row += edge
    return both
