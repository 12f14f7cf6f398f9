"""Min/max windows over depth images: any small rectangle of pixels is bounded by one look-up.

Level k has texels of 2^k x 2^k pixels, and over them *windows* of 5 x 5 texels: the window around a pixel's own texel
reaches at least 2 * 2^k pixels to every side. Anchored at the middle and not at a corner, a wider rectangle always
gets a window that contains the old one, which is what keeps *wider margins never free anything* exactly true.
"""

import numpy as np
from numba import njit

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
def fill_levels(texels, camera, tiles, windows):
    """All levels of one camera: its tiles, and its windows from the lowest level on.

    Args:
        texels: (rows, columns) of level 0.
        camera: its record: where each level begins in `windows`.
        tiles: (tiles,), written.
        windows: of all cameras, written.
    """
    fine = texels
    for level in range(camera.levels):
        if level:
            coarse = np.empty(((fine.shape[0] + 1) // 2, (fine.shape[1] + 1) // 2), dtype=np.uint32)
            halve(fine, coarse)
            fine = coarse
        rows, columns = fine.shape
        if level == TILE_LEVEL:
            tiles[:] = fine.reshape(rows * columns)
        if level >= camera.lowest:
            first = camera.level_first[level]
            out = windows[first : first + rows * columns].reshape((rows, columns))
            across = np.empty((rows, 2 * columns), dtype=np.uint16)
            windows_of(fine.view(np.uint16), across, out.view(np.uint16))


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
