"""Naive twins of the pyramid: direct minima over neighbourhoods of pixels. Depths are (least, greatest) in quanta."""

import numpy as np

NO_RETURN = 65535


def bounds_of(texels):
    """Least and greatest of packed texels, as two int arrays."""
    return (texels >> 16).astype(int), NO_RETURN - (texels & 0xFFFF).astype(int)


def packed(least, greatest):
    """The packed texels of two int arrays."""
    return ((least.astype(np.uint64) << 16) | (NO_RETURN - greatest).astype(np.uint64)).astype(np.uint32)


def lowered(least, ignored, threshold):
    """Least depths where a pixel that steps beyond `threshold` from its nearest neighbour falls to that."""
    out = least.copy()
    for v, u in np.ndindex(least.shape):
        around = (slice(max(v - 1, 0), v + 2), slice(max(u - 1, 0), u + 2))
        counted = least[around][~ignored[around]]
        nearest = min(counted.min(), least[v, u]) if counted.size else least[v, u]
        if least[v, u] - nearest > threshold[v, u]:
            out[v, u] = nearest
    return out


def past_specks(least, pitch):
    """Least depths where one pixel, or two side by side, may be less than all pixels about them."""
    out = least.copy()
    rows, columns = least.shape
    for v, u in np.ndindex(least.shape):
        for dv, du in np.ndindex(3, 3):
            speck = {(v, u), (v + dv - 1, u + du - 1)}
            if any(not (0 < y < rows - 1 and 0 < x < columns - 1) for y, x in speck):
                continue
            about = {(y + j - 1, x + i - 1) for y, x in speck for j, i in np.ndindex(3, 3)} - speck
            short = int(min(least[p] for p in about) * (1 - pitch) - 1)
            out[v, u] = max(out[v, u], short)
    return out


def level(least, greatest, k):
    """Bounds over 2^k x 2^k pixels each, of fewer at the edge."""
    rows, columns = (-(-n // 2**k) for n in least.shape)
    low, high = np.zeros((rows, columns), dtype=int), np.zeros((rows, columns), dtype=int)
    for v, u in np.ndindex(low.shape):
        tile = (slice(v * 2**k, (v + 1) * 2**k), slice(u * 2**k, (u + 1) * 2**k))
        low[v, u], high[v, u] = least[tile].min(), greatest[tile].max()
    return low, high


def window(least, greatest, k, u, v):
    """Bounds over the 5 x 5 texels of level k around the texel of pixel (u, v), straight from the pixels."""
    rows = slice(max((v >> k) - 2, 0) << k, ((v >> k) + 3) << k)
    columns = slice(max((u >> k) - 2, 0) << k, ((u >> k) + 3) << k)
    return least[rows, columns].min(), greatest[rows, columns].max()
