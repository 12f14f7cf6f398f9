"""Min/max windows over depth images: any small rectangle of pixels is bounded by one look-up.

A texel is one uint32: least depth in the upper 16 bits, 65535 - greatest in the lower, so that both shrink towards
the conservative side under `min`. Depth is counted in quanta of the camera: least rounded down, greatest up.
Without a return: least 0, greatest `NO_RETURN`. `NEUTRAL` says nothing of either, as of a pixel that is explained.

Level k has texels of 2^k x 2^k pixels, and over them *windows* of 5 x 5 texels: the window around a pixel's own texel
reaches at least 2 * 2^k pixels to every side. Anchored at the middle and not at a corner, a wider rectangle always
gets a window that contains the old one, which is what keeps *wider margins never free anything* exactly true.
"""

import numpy as np
from numba import njit

NO_RETURN = 65535
FAR_CLIP = 65534
NEXT_TO_NOTHING_M = 1e-3
NEUTRAL = np.uint32(0xFFFFFFFF)
RUN = 64
"""Pixels of a row that are looked over before they are worked on."""
REACH = 2
"""Texels that a window reaches to every side."""


@njit(cache=True, nogil=True, inline="always")
def margin_at(depth, m):
    """The margin's polynomial m = (constant, linear, quadratic, quadratic beyond offset, offset) at a depth [m]."""
    beyond = max(depth - m[4], 0.0)
    return m[0] + depth * (m[1] + depth * m[2]) + m[3] * beyond * beyond


@njit(cache=True, nogil=True, error_model="numpy")
def texels_of_frame(least_m, greatest_m, low, high, quantum, model_m, margin, trust, doubt):
    """Level 0: each pixel's bounds in quanta; no return where a depth is not a number within [low, high].

    Pixels that see the machine are marked (`_mark_row`). Arrays by pixel, (rows, columns).

    Args:
        least_m, greatest_m: bounds of depth [m].
        low, high: range of the camera [m].
        quantum: of the camera [m].
        model_m: as `machine.explain` gives it [m], or of no size: nothing is explained.
        margin: of depth, as of `margin_at`.
        trust, doubt: written; doubt may be of no size where nothing is explained.

    Returns:
        First row, one past the last, first column and one past the last of a rectangle about all marked pixels.
    """
    rows, columns = least_m.shape
    top, bottom, left, right = rows, 0, columns, 0
    for v in range(rows):
        _texels_of_row(least_m[v], greatest_m[v], low, high, quantum, trust[v])
        if doubt.shape[0]:
            doubt[v] = trust[v]
        if model_m.shape[0]:
            start, stop = _mark_row(model_m[v], margin, quantum, trust[v], doubt[v])
            if start < stop:
                top, bottom, left, right = min(top, v), v + 1, min(left, start), max(right, stop)
    return top, bottom, left, right


@njit(nogil=True, error_model="numpy")
def _texels_of_row(least_m, greatest_m, low, high, quantum, texels):
    per_metre = np.float32(1.0 / quantum)
    clip = np.float32(FAR_CLIP - 2)
    one, zero = np.float32(1), np.float32(0)
    for n in range(least_m.size):
        u = np.uint64(n)
        near, far = least_m[u], greatest_m[u]
        # comparisons with NaN are false, so NaN is no return
        valid = (near > zero) & (near >= low) & (far <= high) & (far >= near) & (far < np.inf)
        # the product is off by less than a quantum, so one quantum more is surely on the safe side
        least = np.int32(max(min(near * per_metre, clip) - one, zero) if valid else zero)
        greatest = np.int32(min(far * per_metre, clip) + np.float32(2) if valid else np.float32(NO_RETURN))
        texels[u] = np.uint32((least << np.int32(16)) | (np.int32(NO_RETURN) - greatest))


@njit(cache=True, nogil=True, error_model="numpy")
def pass_over_specks(texels, pitch, model_m, margin, quantum, passed):
    """Specks of one or two pixels, near or without a return, amid pixels that all see farther: free to short of them.

    Nothing that the camera can resolve hides in two pixels: what is three pixels wide is seen by a neighbour as well,
    at most a pixel's pitch farther away. Least becomes the least of all neighbours of the speck less their pitch,
    where that is more; greatest stays. Neighbours without a return, or none at the image's edge, leave it as it is.

    Args:
        texels: (rows, columns) of a camera, read.
        pitch: of a pixel, as a share of its depth.
        model_m: (rows, columns) float32 [m], or of no size (`machine.explain`): where it is below zero, it decides and
            not the neighbours.
        margin, quantum: of depth, as of `mark_explained`.
        passed: (rows, columns), written.
    """
    rows, columns = texels.shape
    low, keep = np.uint32(0xFFFF), 1.0 - pitch
    one = np.uint64(1)
    # three rows of what each pixel would leave free of a speck beside it
    short_of = np.zeros((3, columns), dtype=np.float32)
    farther = np.zeros(columns, dtype=np.int32)
    passed[:] = texels
    for v in range(-1, rows - 1):
        following, row = texels[v + 1], short_of[(v + 1) % 3]
        for n in range(columns):
            u = np.uint64(n)
            row[u] = np.float32(np.int32(following[u] >> np.uint32(16))) * np.float32(keep) - np.float32(0.5)
        if v < 1:
            continue
        here, above, middle, below = texels[v], short_of[(v - 1) % 3], short_of[v % 3], short_of[(v + 1) % 3]
        for n in range(columns - 2):
            # only where at least seven of eight neighbours are farther, the pixel can be a speck
            u = np.uint64(n + 1)
            least = np.float32(np.int32(here[u] >> np.uint32(16)))
            farther[u] = (
                np.int32(above[u - one] > least)
                + np.int32(above[u] > least)
                + np.int32(above[u + one] > least)
                + np.int32(middle[u - one] > least)
                + np.int32(middle[u + one] > least)
                + np.int32(below[u - one] > least)
                + np.int32(below[u] > least)
                + np.int32(below[u + one] > least)
            )
        for u in range(1, columns - 1):
            if farther[u] < 7:
                continue
            least = here[u] >> np.uint32(16)
            short = _short_of_neighbours(texels, v, u) * keep - 1.0
            if short > least:
                passed[v, u] = (np.uint32(short) << np.uint32(16)) | (here[u] & low)
    for v in range(model_m.shape[0]):
        for u in range(columns):
            if model_m[v, u] < 0.0:
                passed[v, u] = texels[v, u]
                if model_m[v, u] < -NEXT_TO_NOTHING_M:
                    short = _free_to_model(-model_m[v, u], margin, quantum)
                    passed[v, u] = (max(texels[v, u] >> np.uint32(16), short) << np.uint32(16)) | (
                        texels[v, u] & low
                    )


@njit(cache=True, nogil=True, inline="always")
def _free_to_model(depth, margin, quantum):
    """Least [quanta] of a pixel that is free up to the model's surface at a depth.

    The margin is added to the model's depth because a voxel is compared with its own margin added: what is known of
    the body does not scatter as a measurement does.
    """
    quanta = min(max((depth + margin_at(depth, margin)) / quantum - 1.0, 0.0), float(FAR_CLIP))
    return np.uint32(np.int32(quanta))


@njit(cache=True, nogil=True)
def _short_of_neighbours(texels, v, u):
    """The least that all neighbours see of the speck of this pixel, or of it and one beside it; the best of these."""
    rows, columns = texels.shape
    best = np.uint32(0)
    for dv in range(-1, 2):
        for du in range(-1, 2):
            ov, ou = v + dv, u + du
            if not (0 < ov < rows - 1 and 0 < ou < columns - 1):
                continue
            least = np.uint32(0xFFFF)
            for nv in range(min(v, ov) - 1, max(v, ov) + 2):
                for nu in range(min(u, ou) - 1, max(u, ou) + 2):
                    near_one = abs(nv - v) <= 1 and abs(nu - u) <= 1
                    near_other = abs(nv - ov) <= 1 and abs(nu - ou) <= 1
                    own = (nv == v and nu == u) or (nv == ov and nu == ou)
                    if (near_one or near_other) and not own:
                        least = min(least, texels[nv, nu] >> np.uint32(16))
            best = max(best, least)
    return best


@njit(cache=True, nogil=True, error_model="numpy")
def lower_at_steps(texels, ignored, quantum, step, lowered):
    """Flying pixels: where depth steps, a pixel is trusted only up to the nearest of its 3 x 3 neighbourhood.

    A neighbour without a return counts as least 0, one that is `NEUTRAL` in `ignored` lowers nothing. Greatest stays.
    A step is a difference beyond the polynomial `step` (as of `margin_at`) at the pixel's depth.
    """
    rows, columns = texels.shape
    low = np.uint32(0xFFFF)
    three = np.full((3, columns + 2), 0xFFFF, dtype=np.int32)
    nearest = np.full(columns + 2, 0xFFFF, dtype=np.int32)
    for v in range(-1, rows):
        row = three[(v + 1) % 3]
        if v + 1 < rows:
            following, skipped = texels[v + 1], ignored[v + 1]
            for n in range(columns):
                u = np.uint64(n)
                least = np.int32(following[u] >> np.uint32(16))
                row[u + np.uint64(1)] = np.int32(0xFFFF) if skipped[u] == NEUTRAL else least
        else:
            row[:] = 0xFFFF
        if v < 0:
            continue
        here = texels[v]
        for n in range(columns + 2):
            u = np.uint64(n)
            nearest[u] = min(three[0, u], min(three[1, u], three[2, u]))
        out = lowered[v]
        for n in range(columns):
            u = np.uint64(n)
            near = min(nearest[u], min(nearest[u + np.uint64(1)], nearest[u + np.uint64(2)]))
            least = np.int32(here[u] >> np.uint32(16))
            steps = (least - near) * quantum > margin_at(least * quantum, step)
            out[u] = (np.uint32(near if steps else least) << np.uint32(16)) | (here[u] & low)


@njit(cache=True, nogil=True, inline="always")
def both_least(a, b):
    """Texel-wise minimum of both halves."""
    upper = np.uint32(0xFFFF0000)
    lower = np.uint32(0xFFFF)
    return min(a & upper, b & upper) | min(a & lower, b & lower)


@njit(cache=True, nogil=True)
def halve(fine, coarse):
    """The next level of texels: each is the least of 2 x 2, of fewer at an odd image's edge."""
    rows, columns = fine.shape
    halves = fine.view(np.uint16)
    # two rows into one, both halves of a texel side by side, then pairs of texels, which lie in one word
    least = np.empty((columns + 1) // 2 * 2, dtype=np.uint32)
    least_halves, pairs = least.view(np.uint16), least.view(np.uint64)
    for v in range(coarse.shape[0]):
        upper, lower, out = halves[2 * v], halves[min(2 * v + 1, rows - 1)], coarse[v]
        for n in range(2 * columns):
            u = np.uint64(n)
            least_halves[u] = min(upper[u], lower[u])
        for n in range(columns // 2):
            u = np.uint64(n)
            out[u] = both_least(np.uint32(pairs[u]), np.uint32(pairs[u] >> np.uint64(32)))
        if columns % 2:
            out[coarse.shape[1] - 1] = least[columns - 1]


@njit(cache=True, nogil=True)
def windows_of(texels, across, windows):
    """The least of 5 x 5 texels around each, of fewer at the edge.

    Args:
        texels: (rows, 2 columns) uint16 view of a level: both halves of a texel side by side.
        across: (rows, 2 columns) uint16 scratch.
        windows: (rows, 2 columns) uint16, written.
    """
    rows, width = texels.shape
    for v in range(rows):
        source, target = texels[v], across[v]
        for x in range(width):
            target[x] = source[x]
        for step in range(1, REACH + 1):
            shift = 2 * step
            for x in range(width - shift):
                target[x] = min(target[x], source[x + shift])
            for x in range(width - shift):
                target[x + shift] = min(target[x + shift], source[x])
    for v in range(rows):
        out = windows[v]
        first = across[max(v - REACH, 0)]
        for x in range(width):
            out[x] = first[x]
        for other in range(max(v - REACH, 0) + 1, min(v + REACH + 1, rows)):
            row = across[other]
            for x in range(width):
                out[x] = min(out[x], row[x])


@njit(cache=True, nogil=True)
def squares_of(tiles, edge, squares):
    """The least of `edge` x `edge` texels from each on, of fewer at the lower and right edge.

    Args:
        tiles: (rows, columns) uint32: the least of half as many either way, or single texels.
        edge: 2 or more, a power of two.
        squares: (rows, columns) uint32, written.
    """
    rows, columns = tiles.shape
    half = edge // 2
    for v in range(rows):
        here, below, out = tiles[v], tiles[min(v + half, rows - 1)], squares[v]
        for n in range(columns):
            u = np.uint64(n)
            out[u] = both_least(here[u], below[u])
        # in place from the left: what lies to the right is still as it was
        for n in range(columns - half):
            u = np.uint64(n)
            out[u] = both_least(out[u], out[u + np.uint64(half)])


@njit(cache=True, nogil=True)
def _any_of(row, start, stop):
    """Whether any bit of a part of a row is set."""
    some = np.uint32(0)
    for n in range(start, stop):
        some |= row[np.uint64(n)]
    return some != 0


@njit(cache=True, nogil=True)
def mark_explained(model_m, margin, quantum, trust, doubt):
    """Marks the pixels of an image that see the machine (`_mark_row`)."""
    for v in range(model_m.shape[0]):
        _mark_row(model_m[v], margin, quantum, trust[v], doubt[v])


@njit(nogil=True, error_model="numpy")
def _mark_row(model, margin, quantum, trust, doubt):
    """Pixels of a row that see the machine, as `machine.explain` tells: `NEUTRAL` in `doubt`; in `trust`, those with a
    depth of the model are free up to it, and hidden behind it. First column and one past the last of runs with any.
    """
    columns = model.size
    # as `_free_to_model`, in float32; numbers of their own, or the compiler cannot tell that they never change below
    constant, linear, square = np.float32(margin[0]), np.float32(margin[1]), np.float32(margin[2])
    beyond_square, offset = np.float32(margin[3]), np.float32(margin[4])
    per_metre, most, nothing = np.float32(1.0 / quantum), np.float32(FAR_CLIP), np.float32(-NEXT_TO_NOTHING_M)
    zero, one, two, infinite = np.float32(0.0), np.float32(1.0), np.float32(2.0), np.float32(np.inf)
    as_bits = model.view(np.uint32)
    left, right = columns, 0
    for start in range(0, columns, RUN):
        stop = min(start + RUN, columns)
        if not _any_of(as_bits, start, stop):
            continue
        left, right = min(left, start), stop
        # without branches, for many pixels at once
        for n in range(start, stop):
            u = np.uint64(n)
            depth = model[u]
            frees = (depth > zero) & (depth < infinite)
            within = depth if frees else one
            beyond = max(within - offset, zero)
            wide = constant + within * (linear + within * square) + beyond_square * beyond * beyond
            least = np.int32(min(max((within + wide) * per_metre - one, zero), most))
            greatest = np.int32(min(within * per_metre + two, most))
            texel = np.uint32((least << np.int32(16)) | (np.int32(NO_RETURN) - greatest))
            trust[u] = texel if frees else trust[u]
            is_machine = (depth > zero) | (depth < nothing)
            doubt[u] = NEUTRAL if is_machine else doubt[u]
    return left, right


@njit(cache=True, nogil=True)
def fill_levels(texels, lowest, firsts, tile_level, tiles, windows):
    """All levels of one camera: its tiles, and its windows from level `lowest` on.

    Args:
        texels: (rows, columns) of level 0.
        firsts: (levels,) where each level begins in `windows`.
        tile_level: whose texels are the tiles.
        tiles: (tiles,), written.
        windows: of all cameras, written.
    """
    fine = texels
    for level in range(firsts.size):
        if level:
            coarse = np.empty(((fine.shape[0] + 1) // 2, (fine.shape[1] + 1) // 2), dtype=np.uint32)
            halve(fine, coarse)
            fine = coarse
        rows, columns = fine.shape
        if level == tile_level:
            tiles[:] = fine.reshape(rows * columns)
        if level >= lowest:
            out = windows[firsts[level] : firsts[level] + rows * columns].reshape((rows, columns))
            across = np.empty((rows, 2 * columns), dtype=np.uint16)
            windows_of(fine.view(np.uint16), across, out.view(np.uint16))


@njit(cache=True, nogil=True)
def fill_tiles(texels, top, bottom, left, right, tiles):
    """Tiles of 4 x 4 texels that a rectangle meets, each the least of its texels; others are left as they are.

    Args:
        texels: (rows, columns).
        top, bottom, left, right: first row, one past the last, first column, one past the last.
        tiles: (rows / 4, columns / 4), rounded up, written.
    """
    if top >= bottom or left >= right:
        return
    rows, columns = texels.shape
    begin, end = left // 4, (right + 3) // 4
    stop = min(4 * end, columns)
    # four rows into one, both halves of a texel side by side; beyond the image's edge nothing is less
    least = np.full(4 * end, NEUTRAL, dtype=np.uint32)
    least_halves, halves = least.view(np.uint16), texels.view(np.uint16)
    for tile in range(top // 4, (bottom + 3) // 4):
        first, out = halves[4 * tile], tiles[tile]
        for n in range(8 * begin, 2 * stop):
            u = np.uint64(n)
            least_halves[u] = first[u]
        for v in range(4 * tile + 1, min(4 * tile + 4, rows)):
            row = halves[v]
            for n in range(8 * begin, 2 * stop):
                u = np.uint64(n)
                least_halves[u] = min(least_halves[u], row[u])
        for n in range(begin, end):
            u = np.uint64(4 * n)
            one = both_least(least[u], least[u + np.uint64(1)])
            other = both_least(least[u + np.uint64(2)], least[u + np.uint64(3)])
            out[n] = both_least(one, other)
