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
NEUTRAL = np.uint32(0xFFFFFFFF)
REACH = 2
"""Texels that a window reaches to every side."""


@njit(cache=True, nogil=True, inline="always")
def margin_at(depth, m):
    """The margin's polynomial m = (constant, linear, quadratic, quadratic beyond offset, offset) at a depth [m]."""
    beyond = max(depth - m[4], 0.0)
    return m[0] + depth * (m[1] + depth * m[2]) + m[3] * beyond * beyond


@njit(cache=True, nogil=True, error_model="numpy")
def texels_of_frame(least_m, greatest_m, low, high, quantum, texels):
    """Level 0: each pixel's bounds in quanta; no return where a depth is not a number within [low, high]."""
    rows, columns = least_m.shape
    per_metre = np.float32(1.0 / quantum)
    clip = np.float32(FAR_CLIP - 2)
    one, zero = np.float32(1), np.float32(0)
    for v in range(rows):
        for u in range(columns):
            near, far = least_m[v, u], greatest_m[v, u]
            # comparisons with NaN are false, so NaN is no return
            valid = (near > zero) & (near >= low) & (far <= high) & (far >= near) & (far < np.inf)
            # the product is off by less than a quantum, so one quantum more is surely on the safe side
            least = np.int32(max(min(near * per_metre, clip) - one, zero) if valid else zero)
            greatest = np.int32(
                min(far * per_metre, clip) + np.float32(2) if valid else np.float32(NO_RETURN)
            )
            texels[v, u] = np.uint32((least << np.int32(16)) | (np.int32(NO_RETURN) - greatest))


@njit(cache=True, nogil=True)
def lower_at_steps(texels, ignored, quantum, step, lowered):
    """Flying pixels: where depth steps, a pixel is trusted only up to the nearest of its 3 x 3 neighbourhood.

    A neighbour without a return counts as least 0. Greatest stays. A neighbour that is `NEUTRAL` in `ignored` (of no
    size: none is) lowers nothing. A step is a difference beyond the polynomial `step` (as of `margin_at`) at the
    pixel's depth.
    """
    rows, columns = texels.shape
    has_ignored = ignored.size > 0
    low = np.uint32(0xFFFF)
    for v in range(rows):
        for u in range(columns):
            texel = texels[v, u]
            least = texel >> np.uint32(16)
            near = least
            for dv in range(max(v - 1, 0), min(v + 2, rows)):
                for du in range(max(u - 1, 0), min(u + 2, columns)):
                    if has_ignored and ignored[dv, du] == NEUTRAL:
                        continue
                    near = min(near, texels[dv, du] >> np.uint32(16))
            if near < least and (least - near) * quantum > margin_at(least * quantum, step):
                least = near
            lowered[v, u] = (least << np.uint32(16)) | (texel & low)


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
    for v in range(coarse.shape[0]):
        upper = fine[2 * v]
        lower = fine[min(2 * v + 1, rows - 1)]
        out = coarse[v]
        for u in range(columns // 2):
            out[u] = both_least(
                both_least(upper[2 * u], upper[2 * u + 1]), both_least(lower[2 * u], lower[2 * u + 1])
            )
        if columns % 2:
            out[coarse.shape[1] - 1] = both_least(upper[columns - 1], lower[columns - 1])


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


@njit(cache=True, nogil=True, error_model="numpy")
def mark_explained(model_m, margin, quantum, trust, doubt):
    """Pixels that see the machine: free up to the model's surface, hidden behind it, and without a say in disputes.

    The margin is added to the model's depth because a voxel is compared with its own margin added: what is known of
    the body does not scatter as a measurement does.
    """
    rows, columns = model_m.shape
    any_explained = False
    for v in range(rows):
        for u in range(columns):
            depth = model_m[v, u]
            if depth > 0.0:
                any_explained = True
                near = (depth + margin_at(depth, margin)) / quantum - 1.0
                least = np.uint32(min(max(near, 0.0), float(FAR_CLIP)))
                greatest = np.uint32(min(depth / quantum + 2.0, float(FAR_CLIP)))
                trust[v, u] = (least << np.uint32(16)) | (np.uint32(NO_RETURN) - greatest)
                doubt[v, u] = NEUTRAL
    return any_explained


@njit(cache=True, nogil=True)
def ignore_explained(model_m, texels, doubt):
    """Copies texels, `NEUTRAL` where the model explains the pixel."""
    for v in range(texels.shape[0]):
        for u in range(texels.shape[1]):
            doubt[v, u] = NEUTRAL if model_m[v, u] > 0.0 else texels[v, u]
