"""Pixels that fly, and those that lost their return: what their neighbours say of how far they are free."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.neighbours import is_about
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.reconstruct.kernels.texels import (
    NEUTRAL,
    NEXT_TO_NOTHING_M,
    RUN,
    any_of,
    free_to_model,
    mark_row,
    texels_of_row,
)

BAND = 24
"""Rows of pixels that are taken from depth to texels before the next ones are."""


@njit(cache=True, nogil=True, error_model="numpy")
def pass_over_specks(texels, pitch, model_m, counting, passed):
    """Specks of one or two pixels, near or without a return, amid pixels that all see farther: free to short of them.

    Nothing that the camera can resolve hides in two pixels: what is three pixels wide is seen by a neighbour as well,
    at most a pixel's pitch farther away. Least becomes the least of all neighbours of the speck less their pitch,
    where that is more; greatest stays. Neighbours without a return, or none at the image's edge, leave it as it is.

    Args:
        texels: (rows, columns) of a camera, read.
        pitch: of a pixel, as a share of its depth.
        model_m: (rows, columns) float32 [m], or of no size (`machine.explain`): where it is below zero, it decides and
            not the neighbours.
        counting: of the camera.
        passed: (rows, columns), written.
    """
    _pass_rows(texels, pitch, model_m, counting, passed, (0, texels.shape[0]))


@njit(cache=True, nogil=True, error_model="numpy")
def fly(bounds_m, counting, model_m, near, scratch, own):
    """Level 0 of a camera whose pixels fly, from depth to what its pixels free and what they measured.

    `texels.texels_of_frame`, `pass_over_specks` and `lower_at_steps`, and explained pixels marked again: one after the
    other for some rows at a time, which stay in the processor's cache meanwhile.

    Args:
        bounds_m, counting, model_m: as of `texels.texels_of_frame`.
        near: the pitch of `pass_over_specks`, and the step of `lower_at_steps`.
        scratch: two arrays (rows, columns) uint32.
        own: trust and doubt, (rows, columns) uint32, written.

    Returns:
        As `texels.texels_of_frame`.
    """
    least_m, greatest_m = bounds_m
    (pitch, step), (raw, passed), (trust, doubt) = near, scratch, own
    rows, columns = trust.shape
    top, bottom, left, right = rows, 0, columns, 0
    read, looked_at = 0, 0
    for first in range(0, rows, BAND):
        stop = min(first + BAND, rows)
        # specks are judged by two rows about them, steps by one
        for v in range(read, min(stop + 3, rows)):
            start, end = texels_of_row((least_m[v], greatest_m[v]), counting, model_m, v, raw[v], doubt[v])
            if start < end:
                top, bottom, left, right = min(top, v), v + 1, min(left, start), max(right, end)
        read = min(stop + 3, rows)
        _pass_rows(raw, pitch, model_m, counting, passed, (looked_at, min(stop + 1, rows)))
        looked_at = min(stop + 1, rows)
        _lower_rows(passed, doubt, counting.quantum, step, trust, (first, stop))
        for v in range(min(first, model_m.shape[0]), min(stop, model_m.shape[0])):
            mark_row(model_m[v], counting, trust[v], doubt[v])
    return top, bottom, left, right


@njit(nogil=True, error_model="numpy")
def _pass_rows(texels, pitch, model_m, counting, passed, band):
    """As `pass_over_specks`, for a band of rows: the first, and one past the last."""
    rows, columns = texels.shape
    keep, (first, end) = 1.0 - pitch, band
    # three rows of what each pixel would leave free of a speck beside it
    short_of = np.zeros((3, columns), dtype=np.float32)
    farther = np.zeros(columns, dtype=np.int32)
    for v in range(first, end):
        passed[v] = texels[v]
    # no pixel of the image's first and last row is a speck
    first_inside = max(first, 1)
    for v in range(first_inside - 2, min(end, rows - 1)):
        _leave_short_of(texels[v + 1], np.float32(keep), short_of[(v + 1) % 3])
        if v < first_inside:
            continue
        _count_farther(texels[v], short_of[(v - 1) % 3], short_of[v % 3], short_of[(v + 1) % 3], farther)
        for start in range(1, columns - 1, RUN):
            stop = min(start + RUN, columns - 1)
            # only where at least seven of eight neighbours are farther, the pixel can be a speck
            if _most_of(farther, start, stop) < 7:
                continue
            for u in range(start, stop):
                if farther[u] < 7:
                    continue
                short = _short_of_neighbours(texels, v, u) * keep - 1.0
                if short > texels[v, u] >> np.uint32(16):
                    passed[v, u] = _with_least(texels[v, u], np.uint32(short))
    for v in range(min(first, model_m.shape[0]), min(end, model_m.shape[0])):
        _pass_machine(texels[v], model_m[v], counting, passed[v])


@njit(nogil=True, error_model="numpy")
def _pass_machine(texels, model, counting, passed):
    """Where the model is below zero in a row of pixels, it decides."""
    signs = model.view(np.uint32)
    for start in range(0, model.size, RUN):
        stop = min(start + RUN, model.size)
        if not any_of(signs, start, stop) >> np.uint32(31):
            continue
        for u in range(start, stop):
            if model[u] < 0.0:
                least = texels[u] >> np.uint32(16)
                if model[u] < -NEXT_TO_NOTHING_M:
                    least = max(least, free_to_model(-model[u], counting))
                passed[u] = _with_least(texels[u], least)


@njit(nogil=True)
def _leave_short_of(texels, keep, short_of):
    """What each pixel of a row would leave free of a speck beside it."""
    for n in range(texels.size):
        u = np.uint64(n)
        short_of[u] = np.float32(np.int32(texels[u] >> np.uint32(16))) * keep - np.float32(0.5)


@njit(nogil=True)
def _most_of(numbers, start, stop):
    """The greatest of a part of a row, at least 0."""
    most = np.int32(0)
    for n in range(start, stop):
        most = max(most, numbers[np.uint64(n)])
    return most


@njit(nogil=True, inline="always")
def _with_least(texel, least):
    """A texel with another least depth [quanta]."""
    return (least << np.uint32(16)) | (texel & np.uint32(0xFFFF))


@njit(nogil=True, error_model="numpy")
def _count_farther(here, above, middle, below, farther):
    """How many of the eight neighbours of each pixel of a row are farther; without branches, for many pixels at once.

    Args:
        here: texels of the row.
        above, middle, below: of three rows, what each pixel would leave free of a speck beside it [quanta].
        farther: written, but for the first and last pixel.
    """
    one = np.uint64(1)
    for n in range(here.size - 2):
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
                    if is_about((nv, nu), (v, u), (ov, ou)):
                        least = min(least, texels[nv, nu] >> np.uint32(16))
            best = max(best, least)
    return best


@njit(cache=True, nogil=True, error_model="numpy")
def lower_at_steps(texels, ignored, quantum, step, lowered):
    """Flying pixels: where depth steps, a pixel is trusted only up to the nearest of its 3 x 3 neighbourhood.

    A neighbour without a return counts as least 0, one that is `NEUTRAL` in `ignored` lowers nothing. Greatest stays.

    Args:
        texels, ignored: (rows, columns), read.
        quantum: of the camera [m].
        step: a step is a difference beyond this `DepthMargin` at the pixel's depth.
        lowered: (rows, columns), written.
    """
    _lower_rows(texels, ignored, quantum, step, lowered, (0, texels.shape[0]))


@njit(nogil=True, error_model="numpy")
def _lower_rows(texels, ignored, quantum, step, lowered, band):
    """As `lower_at_steps`, for a band of rows: the first, and one past the last."""
    rows, columns = texels.shape
    first, end = band
    three = np.full((3, columns + 2), 0xFFFF, dtype=np.int32)
    nearest = np.full(columns + 2, 0xFFFF, dtype=np.int32)
    for v in range(max(first - 2, -1), end):
        row = three[(v + 1) % 3]
        if v + 1 < rows:
            _nearest_of_row(texels[v + 1], ignored[v + 1], row)
        else:
            row[:] = 0xFFFF
        if v < first:
            continue
        for n in range(columns + 2):
            u = np.uint64(n)
            nearest[u] = min(three[0, u], min(three[1, u], three[2, u]))
        _lower_row(texels[v], nearest, quantum, step, lowered[v])


@njit(nogil=True)
def _nearest_of_row(texels, ignored, nearest):
    """Least depth of each pixel of a row, from the second number on [quanta]; of one ignored the most there is."""
    for n in range(texels.size):
        u = np.uint64(n)
        least = np.int32(texels[u] >> np.uint32(16))
        nearest[u + np.uint64(1)] = np.int32(0xFFFF) if ignored[u] == NEUTRAL else least


@njit(nogil=True, error_model="numpy")
def _lower_row(texels, nearest, quantum, step, lowered):
    """Lowers one row; `nearest`: the least of three rows, one number beside the row on either side [quanta]."""
    for n in range(texels.size):
        u = np.uint64(n)
        near = min(nearest[u], min(nearest[u + np.uint64(1)], nearest[u + np.uint64(2)]))
        least = np.int32(texels[u] >> np.uint32(16))
        steps = (least - near) * quantum > margin_at(step, least * quantum)
        lowered[u] = _with_least(texels[u], np.uint32(near if steps else least))
