"""What one pixel says: its depth's bounds packed into a texel, and what the machine explains of them.

A texel is one uint32: least depth in the upper 16 bits, 65535 - greatest in the lower, so that both shrink towards
the conservative side under `min`. Depth is counted in quanta of the camera: least rounded down, greatest up.
Without a return: least 0, greatest `NO_RETURN`. `NEUTRAL` says nothing of either, as of a pixel that is explained.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.noise import DepthMargin, in_float32, margin_at

NO_RETURN = 65535
FAR_CLIP = 65534
NEXT_TO_NOTHING_M = 1e-3
NEUTRAL = np.uint32(0xFFFFFFFF)
RUN = 64
"""Pixels of a row that are looked over before they are worked on."""


class Counting(NamedTuple):
    """How a camera counts depth: its range [m], the quantum, a power of two [m], and the margin."""

    min_depth: float
    max_depth: float
    quantum: float
    margin: DepthMargin


@njit(cache=True, nogil=True, error_model="numpy")
def texels_of_frame(bounds_m, counting, model_m, own, within):
    """Level 0: each pixel's bounds in quanta; no return where a depth is not a number within the camera's range.

    Pixels that see the machine are marked (`mark_row`). Arrays by pixel, (rows, columns).

    Args:
        bounds_m: least and greatest depth, two arrays [m].
        counting: of the camera.
        model_m: as `machine.explain` gives it [m], or of no size: nothing is explained.
        own: trust and doubt, written; doubt may be of no size where nothing is explained.
        within: first row, one past the last, first column and one past the last of the pixels that are worked on.

    Returns:
        First row, one past the last, first column and one past the last of a rectangle about all marked pixels.
    """
    least_m, greatest_m = bounds_m
    trust, doubt = own
    first_row, last_row, first, end = within
    top, bottom, left, right = last_row, first_row, end, first
    for v in range(first_row, last_row):
        depths = least_m[v, first:end], greatest_m[v, first:end]
        if not doubt.shape[0]:
            _bounds_of_row(depths[0], depths[1], counting, trust[v, first:end])
            continue
        texels_of_row(depths, counting, trust[v, first:end], doubt[v, first:end])
        if model_m.shape[0]:
            start, stop = mark_row(model_m[v, first:end], counting, trust[v, first:end], doubt[v, first:end])
            if start < stop:
                top, bottom = min(top, v), v + 1
                left, right = min(left, first + start), max(right, first + stop)
    return top, bottom, left, right


@uncounted(error_model="numpy")
def texels_of_row(bounds_m, counting, trust, doubt):
    """One row of `texels_of_frame`, without the machine.

    Args:
        bounds_m: least and greatest depth of the row [m].
        counting: of the camera.
        trust, doubt: of the row, written.
    """
    _bounds_of_row(bounds_m[0], bounds_m[1], counting, trust)
    for n in range(trust.size):
        u = np.uint64(n)
        doubt[u] = trust[u]


@uncounted(error_model="numpy")
def _bounds_of_row(least_m, greatest_m, counting, texels):
    """Bounds of one row in quanta."""
    low, high = np.float32(counting.min_depth), np.float32(counting.max_depth)
    per_metre = np.float32(1.0 / counting.quantum)
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


@njit(cache=True, nogil=True, inline="always")
def free_to_model(depth, counting):
    """Least [quanta] of a pixel that is free up to the model's surface at a depth.

    The margin is added to the model's depth because a voxel is compared with its own margin added: what is known of
    the body does not scatter as a measurement does.
    """
    quanta = (depth + margin_at(counting.margin, depth)) / counting.quantum - 1.0
    return np.uint32(np.int32(min(max(quanta, 0.0), float(FAR_CLIP))))


@uncounted(cache=True)
def any_of(row, start, stop):
    """The bits that any number of a part of a row has.

    Args:
        row: whole numbers.
        start, stop: of the part, the second not in it.
    """
    some = np.uint32(0)
    for n in range(start, stop):
        # kept a word of 32 bits: as one of 64, half as many are looked at in one step
        some = np.uint32(some | row[np.uint64(n)])
    return some


@uncounted(error_model="numpy")
def mark_row(model, counting, trust, doubt):
    """Pixels of a row that see the machine, as `machine.explain` tells: `NEUTRAL` in `doubt`; in `trust`, those with a
    depth of the model are free up to it, and hidden behind it. First column and one past the last of runs with any.

    Args:
        model: of the row, as of `texels_of_frame`.
        counting: of the camera.
        trust, doubt: of the row, changed.
    """
    columns = model.size
    # as `free_to_model`, in float32
    margin, per_metre = in_float32(counting.margin), np.float32(1.0 / counting.quantum)
    most, nothing = np.float32(FAR_CLIP), np.float32(-NEXT_TO_NOTHING_M)
    zero, one, two, infinite = np.float32(0.0), np.float32(1.0), np.float32(2.0), np.float32(np.inf)
    as_bits = model.view(np.uint32)
    left, right = columns, 0
    for start in range(0, columns, RUN):
        stop = min(start + RUN, columns)
        if not any_of(as_bits, start, stop):
            continue
        left, right = min(left, start), stop
        # without branches, for many pixels at once
        for n in range(start, stop):
            u = np.uint64(n)
            depth = model[u]
            frees = (depth > zero) & (depth < infinite)
            within = depth if frees else one
            wide = margin_at(margin, within)
            least = np.int32(min(max((within + wide) * per_metre - one, zero), most))
            greatest = np.int32(min(within * per_metre + two, most))
            texel = np.uint32((least << np.int32(16)) | (np.int32(NO_RETURN) - greatest))
            trust[u] = texel if frees else trust[u]
            is_machine = (depth > zero) | (depth < nothing)
            doubt[u] = NEUTRAL if is_machine else doubt[u]
    return left, right


@njit(inline="always")
def greatest_of(texel):
    """Greatest depth of a texel [quanta]."""
    return np.uint32(NO_RETURN) - (texel & np.uint32(0xFFFF))
