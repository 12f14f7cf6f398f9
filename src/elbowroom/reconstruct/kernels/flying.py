"""Pixels that fly, and those that lost their return: what their neighbours say of how far they are free."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import lowest_bit, uncounted
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

SPREAD = 3
"""Pixels so far about one have a say in how far it is free."""
RING = 8
"""Rows of an image that are at hand at a time; row v lies where v modulo this says."""
NOBODY = np.int32(0xFFFF)
"""Nearer than this everything is [quanta]."""


class Rows(NamedTuple):
    """Memory for rows of pixels.

    Of each row of a ring: texels; short_of, what each leaves free of a speck beside it, float32 [quanta]; passed,
    texels with specks passed over; least, the least depth of each, a number beside the row on either side, int32
    [quanta]; marked (ring, 2), where the machine is. Of one row: nearest, the least of three of these; marks, a byte a
    pixel, whole words of eight; about (8, 5) int32, for pixels about one.
    """

    texels: np.ndarray
    short_of: np.ndarray
    passed: np.ndarray
    least: np.ndarray
    nearest: np.ndarray
    marks: np.ndarray
    about: np.ndarray
    marked: np.ndarray


@njit(nogil=True)
def _memory(ring, columns):
    """Memory for so many rows of so many pixels."""
    return Rows(
        np.empty((ring, columns), dtype=np.uint32),
        np.empty((ring, columns), dtype=np.float32),
        np.empty((ring, columns), dtype=np.uint32),
        np.full((ring, columns + 2), NOBODY, dtype=np.int32),
        np.empty(columns + 2, dtype=np.int32),
        np.zeros(8 * (columns // 8 + 1), dtype=np.uint8),
        np.empty((8, 5), dtype=np.int32),
        np.zeros((ring, 2), dtype=np.int64),
    )


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
    rows, columns = texels.shape
    memory = _memory(rows, columns)
    for v in range(rows):
        memory.texels[v] = texels[v]
        _leave_short_of(texels[v], np.float32(1.0 - pitch), memory.short_of[v])
    for v in range(rows):
        _pass_row(memory, v, rows, 1.0 - pitch, passed[v])
        if model_m.shape[0]:
            _pass_machine(texels[v], model_m[v], counting, passed[v])


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
    rows, columns = texels.shape
    memory = _memory(rows + 1, columns)
    for v in range(rows):
        _least_of_row(texels[v], ignored[v], memory.least[v])
    for v in range(rows):
        _lower_row(texels[v], memory, v, (quantum, step), lowered[v])


@njit(cache=True, nogil=True, error_model="numpy")
def fly(bounds_m, counting, model_m, near, own, within):
    """Level 0 of a camera whose pixels fly, from depth to what its pixels free and what they measured.

    `texels.texels_of_frame`, `pass_over_specks` and `lower_at_steps`, and explained pixels marked again: each row goes
    through all of it while the rows about it are in the processor's cache.

    Args:
        bounds_m, counting, model_m: as of `texels.texels_of_frame`.
        near: the pitch of `pass_over_specks`, and the step of `lower_at_steps`.
        own: trust and doubt, (rows, columns) uint32, written.
        within: first row, one past the last, first column and one past the last of the pixels that are worked on, as
            if they were all of the image: as in all of it are those `SPREAD` pixels from a side that is not its own.

    Returns:
        As `texels.texels_of_frame`.
    """
    memory = _memory(RING, within[3] - within[2])
    return _fly(bounds_m, counting, model_m, near, own, within, memory)


@uncounted(error_model="numpy")
def _fly(bounds_m, counting, model_m, near, own, within, memory):
    """As `fly`."""
    pitch, step = near
    trust, doubt = own
    first_row, last_row, first, end = within
    rows, has_model = last_row - first_row, model_m.shape[0] > 0
    top, bottom, left, right = last_row, first_row, end, first
    for v in range(rows + SPREAD):
        if v < rows:
            at, ring = first_row + v, v % RING
            texels = memory.texels[ring]
            texels_of_row(
                (bounds_m[0][at, first:end], bounds_m[1][at, first:end]),
                counting,
                texels,
                doubt[at, first:end],
            )
            if has_model:
                start, stop = mark_row(model_m[at, first:end], counting, texels, doubt[at, first:end])
                memory.marked[ring, 0], memory.marked[ring, 1] = start, stop
                if start < stop:
                    top, bottom, left, right = (
                        min(top, at),
                        at + 1,
                        min(left, first + start),
                        max(right, first + stop),
                    )
            _leave_short_of(texels, np.float32(1.0 - pitch), memory.short_of[ring])
        # specks are judged by two rows about them
        v -= 2
        if 0 <= v < rows:
            at, ring = first_row + v, v % RING
            passed = memory.passed[ring]
            _pass_row(memory, v, rows, 1.0 - pitch, passed)
            if has_model:
                start, stop = memory.marked[ring, 0], memory.marked[ring, 1]
                model = model_m[at, first + start : first + max(start, stop)]
                _pass_machine(memory.texels[ring, start:], model, counting, passed[start:])
            _least_of_row(passed, doubt[at, first:end], memory.least[ring])
        elif v == rows:
            memory.least[v % RING, :] = NOBODY
        # and steps by one
        v -= 1
        if v >= 0:
            at, ring = first_row + v, v % RING
            lowered = trust[at, first:end]
            _lower_row(memory.passed[ring], memory, v, (counting.quantum, step), lowered)
            if has_model:
                start, stop = memory.marked[ring, 0], memory.marked[ring, 1]
                model = model_m[at, first + start : first + max(start, stop)]
                mark_row(model, counting, lowered[start:], doubt[at, first + start : end])
    return top, bottom, left, right


@uncounted(error_model="numpy")
def _pass_row(memory, v, rows, keep, passed):
    """As `pass_over_specks`, of one row, but for the machine.

    Args:
        memory: with texels of two rows before and after it, and what those of one row leave free.
        v, rows: which row of how many.
        keep: what of its depth a pixel leaves free of a speck beside it.
        passed: of the row, written.
    """
    ring = memory.texels.shape[0]
    texels = memory.texels[v % ring]
    # no pixel of the image's first and last row is a speck
    if v < 1 or v > rows - 2:
        for n in range(texels.size):
            u = np.uint64(n)
            passed[u] = texels[u]
        return
    short_of = memory.short_of
    _mark_near(
        texels, short_of[(v - 1) % ring], short_of[v % ring], short_of[(v + 1) % ring], memory.marks, passed
    )
    about = max(v - 2, 0) % ring, v - 1, v, v + 1, min(v + 2, rows - 1)
    about = about[0], about[1] % ring, about[2] % ring, about[3] % ring, about[4] % ring
    words = memory.marks.view(np.uint64)
    for eight in range(words.size):
        rest = words[eight]
        while rest:
            u = 8 * eight + (lowest_bit(rest) >> 3)
            rest &= rest - np.uint64(1)
            if 2 <= v < rows - 2 and 2 <= u < texels.size - 2:
                best = _short_of_neighbours(memory.texels, about, u, memory.about)
            else:
                best = _short_at_edge(memory.texels, v, u, rows)
            short = np.uint32(best) * keep - 1.0
            if short > texels[u] >> np.uint32(16):
                passed[u] = _with_least(texels[u], np.uint32(short))


@uncounted(error_model="numpy")
def _mark_near(texels, above, middle, below, marks, passed):
    """Which pixels of a row may be a speck: at least seven of eight neighbours are farther. Also copies the row.

    Without branches, for many pixels at once.

    Args:
        texels: of the row.
        above, middle, below: of three rows, what each pixel would leave free of a speck beside it [quanta].
        marks: written, but for the first and last pixel.
        passed: of the row, written.
    """
    one = np.uint64(1)
    for n in range(texels.size):
        u = np.uint64(n)
        passed[u] = texels[u]
    for n in range(texels.size - 2):
        u = np.uint64(n + 1)
        least = np.float32(np.int32(texels[u] >> np.uint32(16)))
        farther = (
            np.int32(above[u - one] > least)
            + np.int32(above[u] > least)
            + np.int32(above[u + one] > least)
            + np.int32(middle[u - one] > least)
            + np.int32(middle[u + one] > least)
            + np.int32(below[u - one] > least)
            + np.int32(below[u] > least)
            + np.int32(below[u + one] > least)
        )
        marks[u] = np.uint8(farther > np.int32(6))


@uncounted(error_model="numpy")
def _pass_machine(texels, model, counting, passed):
    """Where the model is below zero in a part of a row of pixels, it decides."""
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


@uncounted(error_model="numpy")
def _leave_short_of(texels, keep, short_of):
    """What each pixel of a row would leave free of a speck beside it."""
    for n in range(texels.size):
        u = np.uint64(n)
        short_of[u] = np.float32(np.int32(texels[u] >> np.uint32(16))) * keep - np.float32(0.5)


@njit(nogil=True, inline="always")
def _with_least(texel, least):
    """A texel with another least depth [quanta]."""
    return np.uint32((least << np.uint32(16)) | (texel & np.uint32(0xFFFF)))


@uncounted(error_model="numpy")
def _short_of_neighbours(texels, rows, u, about):
    """As `_short_at_edge`, of a pixel two or more from every edge: 5 x 5 pixels about it are worked out at once.

    Args:
        texels: rows in any order.
        rows: where in it the five rows about the pixel are.
        u: its column.
        about: (8, 5) int32, scratch.
    """
    two, most = np.uint32(16), np.int32(0xFFFF)
    for j in range(5):
        column = u - 2 + j
        about[0, j] = np.int32(texels[rows[0], column] >> two)
        about[1, j] = np.int32(texels[rows[1], column] >> two)
        about[2, j] = np.int32(texels[rows[2], column] >> two)
        about[3, j] = np.int32(texels[rows[3], column] >> two)
        about[4, j] = np.int32(texels[rows[4], column] >> two)
    about[2, 2] = most
    # the two least of its eight neighbours
    least, second = most, most
    for i in range(1, 4):
        for j in range(1, 4):
            here = about[i, j]
            second = min(second, max(least, here))
            least = min(least, here)
    best = least
    for j in range(1, 4):
        # the least of three side by side, in each of five rows
        row0 = min(about[0, j - 1], min(about[0, j], about[0, j + 1]))
        row1 = min(about[1, j - 1], min(about[1, j], about[1, j + 1]))
        row2 = min(about[2, j - 1], min(about[2, j], about[2, j + 1]))
        row3 = min(about[3, j - 1], min(about[3, j], about[3, j + 1]))
        row4 = min(about[4, j - 1], min(about[4, j], about[4, j + 1]))
        side1 = min(about[1, j - 1], about[1, j + 1])
        side2 = min(about[2, j - 1], about[2, j + 1])
        side3 = min(about[3, j - 1], about[3, j + 1])
        best = max(best, min(min(row0, min(side1, row2)), second if about[1, j] == least else least))
        if j != 2:
            best = max(best, min(min(row1, min(side2, row3)), second if about[2, j] == least else least))
        best = max(best, min(min(row2, min(side3, row4)), second if about[3, j] == least else least))
    return best


@uncounted()
def _short_at_edge(texels, v, u, rows):
    """The least that all neighbours see of the speck of this pixel, or of it and one beside it; the best of these.

    Args:
        texels: a ring of rows.
        v, u: the pixel.
        rows: how many the image has.
    """
    ring, columns = texels.shape
    best = np.int32(0)
    for dv in range(-1, 2):
        for du in range(-1, 2):
            ov, ou = v + dv, u + du
            if not (0 < ov < rows - 1 and 0 < ou < columns - 1):
                continue
            least = np.int32(0xFFFF)
            for nv in range(min(v, ov) - 1, max(v, ov) + 2):
                for nu in range(min(u, ou) - 1, max(u, ou) + 2):
                    if is_about((nv, nu), (v, u), (ov, ou)):
                        least = min(least, np.int32(texels[nv % ring, nu] >> np.uint32(16)))
            best = max(best, least)
    return best


@uncounted()
def _least_of_row(texels, ignored, least):
    """Least depth of each pixel of a row, from the second number on [quanta]; of one ignored the most there is."""
    for n in range(texels.size):
        u = np.uint64(n)
        here = np.int32(texels[u] >> np.uint32(16))
        least[u + np.uint64(1)] = NOBODY if ignored[u] == NEUTRAL else here


@uncounted(error_model="numpy")
def _lower_row(texels, memory, v, judged, lowered):
    """As `lower_at_steps`, of one row.

    Args:
        texels: of the row.
        memory: with the least depths of the rows before and after it; of a row beyond the image `NOBODY`.
        v: which row.
        judged: the quantum, and the step.
        lowered: of the row, written.
    """
    ring = memory.least.shape[0]
    above, middle, below = (
        memory.least[(v + ring - 1) % ring],
        memory.least[v % ring],
        memory.least[(v + 1) % ring],
    )
    nearest = memory.nearest
    for n in range(nearest.size):
        u = np.uint64(n)
        nearest[u] = min(above[u], min(middle[u], below[u]))
    quantum, step = judged
    for n in range(texels.size):
        u = np.uint64(n)
        near = min(nearest[u], min(nearest[u + np.uint64(1)], nearest[u + np.uint64(2)]))
        least = np.int32(texels[u] >> np.uint32(16))
        steps = (least - near) * quantum > margin_at(step, least * quantum)
        lowered[u] = _with_least(texels[u], np.uint32(near if steps else least))
