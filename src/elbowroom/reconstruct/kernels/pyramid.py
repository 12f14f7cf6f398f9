"""Min/max windows over depth images: any small rectangle of pixels is bounded by one look-up.

Level k has texels of 2^k x 2^k pixels, and over them *windows* of 5 x 5 texels: the window around a pixel's own texel
reaches at least 2 * 2^k pixels to every side. Anchored at the middle and not at a corner, a wider rectangle always
gets a window that contains the old one, which is what keeps *wider margins never free anything* exactly true.
"""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.reconstruct.kernels.texels import NEUTRAL

TILE_LEVEL = 2
"""The level whose texels the pixel test passes over at once: 4 x 4 pixels."""
REACH = 2
"""Texels that a window reaches to every side."""


@njit(cache=True, nogil=True, inline="always")
def both_least(a, b):
    """Texel-wise minimum of both halves."""
    upper = np.uint32(0xFFFF0000)
    lower = np.uint32(0xFFFF)
    return min(a & upper, b & upper) | min(a & lower, b & lower)


@njit(cache=True, nogil=True)
def halve(fine, origin, within, coarse):
    """The next level of texels: each is the least of 2 x 2, of fewer at the edge of what is worked on.

    Args:
        fine: (rows, columns) of a level, or of a part of it.
        origin: row and column of the level that come first in it.
        within: first row, one past the last, first column, one past the last of the level that are worked on.
        coarse: written, those of the next level that hold any of these.
    """
    top, bottom, left, right = within
    # two rows into one, both halves of a texel side by side, then pairs of texels, which lie in one word
    least = np.full(2 * coarse.shape[1], NEUTRAL, dtype=np.uint32)
    begin, end = left - origin[1], right - origin[1]
    odd = left % 2
    least_halves, pairs = least[odd : odd + right - left].view(np.uint16), least.view(np.uint64)
    for v in range(coarse.shape[0]):
        row = 2 * (top // 2 + v)
        upper = fine[max(row, top) - origin[0], begin:end].view(np.uint16)
        lower = fine[min(row + 1, bottom - 1) - origin[0], begin:end].view(np.uint16)
        for n in range(upper.size):
            u = np.uint64(n)
            least_halves[u] = min(upper[u], lower[u])
        out = coarse[v]
        for n in range(out.size):
            u = np.uint64(n)
            out[u] = both_least(np.uint32(pairs[u]), np.uint32(pairs[u] >> np.uint64(32)))


@njit(cache=True, nogil=True)
def windows_of(texels, origin, within, windows):
    """The least of 5 x 5 texels around each, of fewer at the edge of what is worked on.

    Args:
        texels: (rows, columns) of a level, or of a part of it.
        origin, within: as of `halve`.
        windows: (rows, columns) of the level, written in what is worked on.
    """
    top, bottom, left, right = within
    rows, columns = bottom - top, right - left
    # a row with texels beside it on either side than which nothing is less; both halves side by side
    padded = np.full(columns + 2 * REACH, NEUTRAL, dtype=np.uint32)
    row, halves = padded[REACH : REACH + columns], padded.view(np.uint16)
    across = np.empty((rows, 2 * columns), dtype=np.uint16)
    for v in range(rows):
        source, target = texels[top + v - origin[0], left - origin[1] : right - origin[1]], across[v]
        for n in range(columns):
            u = np.uint64(n)
            row[u] = source[u]
        for n in range(2 * columns):
            u = np.uint64(n)
            outer = min(halves[u], halves[u + np.uint64(8)])
            inner = min(halves[u + np.uint64(2)], halves[u + np.uint64(6)])
            target[u] = min(halves[u + np.uint64(4)], min(outer, inner))
    for v in range(rows):
        out = windows[top + v, left:right].view(np.uint16)
        above, over = across[max(v - 2, 0)], across[max(v - 1, 0)]
        under, below = across[min(v + 1, rows - 1)], across[min(v + 2, rows - 1)]
        here = across[v]
        for n in range(2 * columns):
            u = np.uint64(n)
            out[u] = min(here[u], min(min(above[u], over[u]), min(under[u], below[u])))


@njit(cache=True, nogil=True)
def squares_of(tiles, edge, within, squares):
    """The least of `edge` x `edge` texels from each on, of fewer at the lower and right edge of what is worked on.

    Args:
        tiles: (rows, columns) uint32: the least of half as many either way, or single texels.
        edge: 2 or more, a power of two.
        within: first row, one past the last, first column, one past the last of those that are worked on.
        squares: (rows, columns) uint32, written in what is worked on.
    """
    top, bottom, left, right = within
    half = edge // 2
    for v in range(top, bottom):
        here, below = tiles[v, left:right], tiles[min(v + half, bottom - 1), left:right]
        out = squares[v, left:right]
        for n in range(out.size):
            u = np.uint64(n)
            out[u] = both_least(here[u], below[u])
        # in place from the left: what lies to the right is still as it was
        for n in range(out.size - half):
            u = np.uint64(n)
            out[u] = both_least(out[u], out[u + np.uint64(half)])


@uncounted(cache=True, forceinline=True)
def least_of_tiles(squares, first_tile, across, rectangle):
    """The least of a rectangle of tiles: of the squares that cover it, which may overlap.

    Args:
        squares: (4, tiles) of all cameras: the tiles, and the least of 2 x 2, 4 x 4 and 8 x 8 of them from each on
            (`squares_of`).
        first_tile, across: where a camera's tiles begin, and how many are in a row.
        rectangle: first and last row, first and last column; not empty.
    """
    top, bottom, left, right = rectangle
    rows, columns = bottom - top + 1, right - left + 1
    narrow = min(rows, columns)
    level = int(narrow >= 2) + int(narrow >= 4) + int(narrow >= 8)
    edge = 1 << level
    first, last = first_tile + top * across, first_tile + (bottom - edge + 1) * across
    end = right - edge + 1
    both = both_least(
        both_least(squares[level, first + left], squares[level, first + end]),
        both_least(squares[level, last + left], squares[level, last + end]),
    )
    if max(rows, columns) <= 2 * edge:
        return both
    row = top
    while row <= bottom:
        begin = first_tile + min(row, bottom - edge + 1) * across
        column = left
        while column <= right:
            both = both_least(both, squares[level, begin + min(column, end)])
            column += edge
        row += edge
    return both


@njit(cache=True, nogil=True)
def fill_levels(texels, camera, tiles, windows, within):
    """All levels of one camera: its tiles, and its windows from the lowest level on.

    Args:
        texels: (rows, columns) of level 0.
        camera: its record: where each level begins in `windows`.
        tiles: (rows / 4, columns / 4), rounded up, written.
        windows: of all cameras, written.
        within: first row, one past the last, first column and one past the last of the pixels that are worked on, as
            if they were all of the image. What stands above others is left as it is.
    """
    top, bottom, left, right = within
    if top >= bottom or left >= right:
        return
    fine, origin = texels, (0, 0)
    for level in range(camera.levels):
        if level:
            # a texel more than half of them, where the first is an odd one
            above = top // 2, (bottom + 1) // 2, left // 2, (right + 1) // 2
            coarse = np.empty((above[1] - above[0], above[3] - above[2]), dtype=np.uint32)
            halve(fine, origin, (top, bottom, left, right), coarse)
            top, bottom, left, right = above
            fine, origin = coarse, (top, left)
        if level == TILE_LEVEL:
            for v in range(fine.shape[0]):
                tiles[top + v, left:right] = fine[v]
        if level >= camera.lowest:
            first, stride = camera.level_first[level], camera.level_stride[level]
            out = windows[first : first + bottom * stride].reshape((bottom, stride))
            windows_of(fine, origin, (top, bottom, left, right), out)


@njit(cache=True, nogil=True)
def fill_tiles(texels, rectangle, tiles):
    """Tiles of 4 x 4 texels that a rectangle meets, each the least of its texels; others are left as they are.

    Args:
        texels: (rows, columns).
        rectangle: first row, one past the last, first column, one past the last.
        tiles: (rows / 4, columns / 4), rounded up, written.
    """
    top, bottom, left, right = rectangle
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
