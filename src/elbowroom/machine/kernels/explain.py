"""Compares measured depth images with the drawn machine: which pixels are the machine. Arrays in, arrays out."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.neighbours import is_about
from elbowroom.geometry.kernels.noise import sigma
from elbowroom.machine.kernels.returns import (
    MOST_M,
    SUPPORT,
    UNSAFE,
    Scratch,
    has_support,
    is_return,
    least_from,
    mark_row_of_tiles,
    most_to,
    set_run,
    spread_of,
)

RUN = 32
"""Pixels of a row that are looked over before they are worked on."""


class Tolerance(NamedTuple):
    """How far a measured depth d may be from the model and still be the machine's: metres + sigmas * sigma(d)."""

    metres: float
    sigmas: float


class Rows(NamedTuple):
    """Room to work in.

    Fields:
        nothing: a row in which nothing is drawn, shape (width,), float32.
        about: greatest and least inverse depth of a pixel and those above and below it, from one column before the
            image on, shape (2, width + 2), float32 [1/m].
    """

    nothing: np.ndarray
    about: np.ndarray


class Three(NamedTuple):
    """A row of an image between its neighbours, each of shape (width,)."""

    above: np.ndarray
    here: np.ndarray
    below: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def explain(view, depth, canvas, tolerance, model, around):
    """Fills `model` where a measured depth fits what was drawn in the 3 x 3 pixels about it; empties the canvas.

    Sets the voxels of the returns that do not fit, too.

    Args:
        view: the camera.
        depth: (height, width) float32, measured [m, the camera's kind].
        canvas: from `draw` and `to_kind`; nothing is drawn in it afterwards.
        tolerance: how near is near enough.
        model: (height, width) float32 zeros; where a pixel fits, the depth drawn in it, or else nearest about it
            [m, same kind]. Of a camera whose pixels fly, also what `_settle_edges` says.
        around: where to look for other returns, and the plane for their voxels; without tiles: nowhere.
    """
    height, width = view.height, view.width
    rows = Rows(np.zeros(width, dtype=np.float32), np.empty((2, width + 2), dtype=np.float32))
    for v in range(height):
        start, stop = _columns_about(canvas, v - 1, v + 2)
        if start <= stop:
            _compare(view, depth, canvas, v, (start, stop), tolerance, rows, model)
    if view.flying:
        _settle_edges(
            view, depth, canvas, model, np.empty(width, dtype=np.uint8), np.empty(RUN, dtype=np.int32)
        )
    scratch = Scratch(
        np.empty((2, width), dtype=np.float32),
        np.zeros((width + 7) // 8 * 8, dtype=np.uint8),
        np.empty((3, width), dtype=np.float32),
        np.empty((6, width), dtype=np.int32),
        np.empty(width, dtype=np.uint8),
    )
    for row in range(around.near.shape[0]):
        mark_row_of_tiles(view, depth, model, row, around, scratch)
    _wipe(canvas)


@uncounted()
def _wipe(canvas):
    """Makes a canvas empty again."""
    for v in range(canvas.first.size):
        set_run(canvas.inverse[v], canvas.first[v], canvas.last[v] + 1, np.float32(0.0))
        canvas.first[v], canvas.last[v] = canvas.inverse.shape[1], -1


@uncounted()
def _columns_about(canvas, above, below):
    """First and last column drawn in the rows from `above` up to `below`, or beside one; if none is, 0 and -1."""
    first, last, width = canvas.first, canvas.last, canvas.inverse.shape[1]
    start, stop = width, -1
    for row in range(max(0, above), min(first.size, below)):
        start, stop = min(start, first[row]), max(stop, last[row])
    if stop < 0:
        return 0, -1
    return max(0, start - 1), min(width - 1, stop + 1)


@uncounted(error_model="numpy")
def _compare(view, depth, canvas, v, columns, tolerance, rows, model):
    """Fills one row of the model where depth fits; without branches, for many pixels at once.

    Args:
        view, depth, canvas, tolerance, model: as of `explain`.
        v: the row.
        columns: first and last column that is drawn in it or beside it.
        rows: room to work in.
    """
    height, inverse = view.height, canvas.inverse
    above = inverse[v - 1] if v > 0 else rows.nothing
    below = inverse[v + 1] if v + 1 < height else rows.nothing
    _of_three(above, inverse[v], below, columns[0], columns[1], rows.about[0], rows.about[1])
    _fill_model(view, depth[v], inverse[v], columns, tolerance, rows.about[0], rows.about[1], model[v])


@uncounted(error_model="numpy")
def _of_three(above, here, below, start, stop, most, least):
    """Greatest and least inverse depth of three rows, also one column beyond: zero and infinity where there is none.

    Column u of the image is column u + 1 of `most` and `least`.
    """
    zero, far = np.float32(0.0), np.float32(np.inf)
    most[start], least[start], most[stop + 2], least[stop + 2] = zero, far, zero, far
    for n in range(max(0, start - 1), min(here.size, stop + 2)):
        u = np.uint64(n)
        a, b, c = above[u], here[u], below[u]
        most[u + np.uint64(1)] = max(a, max(b, c))
        least[u + np.uint64(1)] = min(
            a if a > zero else far, min(b if b > zero else far, c if c > zero else far)
        )


@uncounted(error_model="numpy")
def _fill_model(view, depth, drawn, columns, tolerance, most, least, model):
    """As `_compare`, with what is least and most in three rows about it."""
    one, zero = np.float32(1.0), np.float32(0.0)
    spread = spread_of(view, tolerance.sigmas, tolerance.metres)
    low, high = np.float32(view.min_depth), np.float32(min(view.max_depth, MOST_M))
    flying = view.flying
    # unsigned indices, or the compiler does one pixel at a time
    for n in range(columns[0], columns[1] + 1):
        u = np.uint64(n)
        middle, after = u + np.uint64(1), u + np.uint64(2)
        nearest = max(most[u], max(most[middle], most[after]))
        farthest = min(least[u], min(least[middle], least[after]))
        d = depth[u]
        slack = sigma(spread, d)
        valid = (d > zero) & (d >= low) & (d <= high)
        fits = valid & (nearest > zero) & ((d + slack) * nearest >= one) & ((d - slack) * farthest <= one)
        # behind the model's nearest surface and beside it: perhaps a mixed pixel of its edge (`_settle_edges`)
        # up to the surface drawn in the pixel itself; beside the drawn edge up to the nearest one about it
        free_to = one / (drawn[u] if drawn[u] > zero else nearest)
        unfit = -free_to if flying & (nearest > zero) else zero
        model[u] = free_to if fits else unfit


@uncounted(error_model="numpy")
def _settle_edges(view, depth, canvas, model, counts, columns):
    """Pixels that the model is about without fitting, below zero on entry by the depth that the model frees.

    Those that see past the machine's edge and stand alone are mixed pixels of the edge: explained, infinity. Those that
    see past it, but not at its edge, and do not stand alone are `UNSAFE`: a surface behind the model's, so the model is
    larger than the machine, or the machine is not there. Others about which all is explained or farther are specks, and
    explained as well: they stay below zero. The rest becomes `UNSAFE`.

    Args:
        view, depth, canvas, model: as of `explain`.
        counts, columns: (width,) uint8 and (`RUN`,) int32, room to work in.
    """
    for turn in range(3):
        for v in range(view.height):
            first, last = _columns_about(canvas, v - 1, v + 2)
            signs = model[v].view(np.uint32)
            # most runs of pixels hold none that is below zero
            for start in range(first, last + 1, RUN):
                stop = min(start + RUN, last + 1)
                if not _any_below_zero(signs, start, stop):
                    continue
                if turn != 1:
                    _count_about(view, depth, model, (start, v), stop, turn, counts)
                for n in range(_list_below_zero(signs, start, stop, columns)):
                    _settle_edge(view, depth, canvas, model, (np.int64(columns[n]), v, turn), counts)


@uncounted()
def _any_below_zero(signs, start, stop):
    """Whether any of a run of float32 numbers, as bits, has a sign."""
    some = np.uint32(0)
    for n in range(start, stop):
        some |= signs[np.uint64(n)]
    return some >> np.uint32(31) != 0


@uncounted()
def _list_below_zero(signs, start, stop, listed):
    """Writes which of a run of float32 numbers, as bits, have a sign; how many. Without branches."""
    count = np.uint64(0)
    for n in range(start, stop):
        listed[count] = n
        count += np.uint64(signs[np.uint64(n)] >> np.uint32(31))
    return np.int64(count)


@uncounted(error_model="numpy")
def _count_about(view, depth, model, at, stop, turn, counts):
    """For each pixel of a run, how many of the eight about it are like it (turn 0: `has_support`), or near (turn 2).

    Near are those that are neither explained nor farther than what the model frees in the pixel. Only of pixels that
    have all eight; others are left as they are.

    Args:
        view, depth, model: as of `explain`.
        at: first column of the run, its row.
        stop: one past its last column.
        turn: as of `_settle_edges`.
        counts: (width,) uint8, written.
    """
    start, v = at
    if not 0 < v < view.height - 1:
        return
    start, stop = max(start, 1), min(stop, view.width - 1)
    measured = Three(depth[v - 1], depth[v], depth[v + 1])
    freed = Three(model[v - 1], model[v], model[v + 1])
    if turn == 0:
        _count_like(view, measured, freed, start, stop, counts)
    else:
        _count_near(view, measured, freed, start, stop, counts)


@uncounted(error_model="numpy")
def _count_like(view, measured, freed, start, stop, counts):
    """As `_count_about`, how many are like a pixel: the test of `has_support`, for many pixels at once."""
    low, high, pitch = least_from(view.min_depth), most_to(view.max_depth), min(view.fx, view.fy)
    for n in range(start, stop):
        u = np.uint64(n)
        d = measured.here[u]
        slack = 4.5 * sigma(view, d) + d / pitch
        counts[u] = _of_eight(_is_like, measured, freed, u, (d, slack, low, high))


@uncounted(error_model="numpy")
def _count_near(view, measured, freed, start, stop, counts):
    """As `_count_about`, how many about a pixel are neither explained nor farther than what the model frees in it."""
    low, high = least_from(view.min_depth), most_to(min(view.max_depth, MOST_M))
    for n in range(start, stop):
        u = np.uint64(n)
        counts[u] = _of_eight(_is_near, measured, freed, u, (-freed.here[u], low, high))


@njit(inline="always")
def _of_eight(test, measured, freed, u, pixel):
    """For how many of the eight pixels about one of column u a test of depth, what is freed, and that pixel is 1."""
    left, right = u - np.uint64(1), u + np.uint64(1)
    return (
        test(measured.above[left], freed.above[left], pixel)
        + test(measured.above[u], freed.above[u], pixel)
        + test(measured.above[right], freed.above[right], pixel)
        + test(measured.here[left], freed.here[left], pixel)
        + test(measured.here[right], freed.here[right], pixel)
        + test(measured.below[left], freed.below[left], pixel)
        + test(measured.below[u], freed.below[u], pixel)
        + test(measured.below[right], freed.below[right], pixel)
    )


@njit(inline="always")
def _is_like(other, free_to, like):
    """Whether a neighbour has no return, or is unexplained and about as deep: 1 or 0."""
    d, slack, low, high = like
    lost = not ((other > np.float32(0.0)) & (other >= low) & (other <= high))
    return np.uint8(lost | ((free_to <= np.float32(0.0)) & (abs(other - d) <= slack)))


@njit(inline="always")
def _is_near(other, free_to, far):
    """Whether a neighbour is neither explained nor a return farther than a depth: 1 or 0."""
    least, low, high = far
    is_far = (other > np.float32(0.0)) & (other >= low) & (other <= high) & (other > least)
    return np.uint8(not ((free_to > np.float32(0.0)) | is_far))


@uncounted(error_model="numpy")
def _settle_edge(view, depth, canvas, model, at, counts):
    """One turn for one pixel of `_settle_edges`.

    Args:
        view, depth, canvas, model: as of `explain`.
        at: its column, its row, the turn.
        counts: of `_count_about` for its row.
    """
    u, v, turn = at
    if turn == 0:
        # with another mark first, so that all are judged by the same neighbours
        d = depth[v, u]
        past = is_return(view, d) and d > -model[v, u]
        if past and not _has_support(view, depth, model, u, v, counts):
            model[v, u] = -np.inf
        elif past and _is_within(canvas, u, v):
            model[v, u] = UNSAFE
    elif turn == 1:
        if model[v, u] == -np.inf:
            model[v, u] = np.inf
    elif model[v, u] != UNSAFE and not _is_speck(view, depth, model, u, v, counts):
        model[v, u] = UNSAFE


@uncounted(error_model="numpy")
def _has_support(view, depth, model, u, v, counts):
    """As `has_support` for a camera whose pixels fly, with what was counted where all eight are in the image."""
    if 0 < v < view.height - 1 and 0 < u < view.width - 1:
        return counts[u] >= SUPPORT
    return has_support(view, depth, model, u, v)


@uncounted(error_model="numpy")
def _is_within(canvas, u, v):
    """Whether a pixel and all of its neighbours are drawn: it lies within the model, not at its edge."""
    height, width = canvas.inverse.shape
    if not (0 < v < height - 1 and 0 < u < width - 1):
        return False
    for nv in range(v - 1, v + 2):
        for nu in range(u - 1, u + 2):
            if not canvas.inverse[nv, nu] > 0.0:
                return False
    return True


@uncounted(error_model="numpy")
def _is_speck(view, depth, model, u, v, counts):
    """Whether all neighbours of a pixel, or of it and one beside it, are explained or see past the model in it.

    `counts`: how many of its neighbours are not, where all eight are in the image.
    """
    if not (0 < v < view.height - 1 and 0 < u < view.width - 1) or counts[u] >= 2:
        return False
    if counts[u] == 0:
        return True
    for ov in range(v - 1, v + 2):
        for ou in range(u - 1, u + 2):
            inside = 0 < ov < view.height - 1 and 0 < ou < view.width - 1
            if inside and _sees_past_all_about(view, depth, model, u, v, ou, ov):
                return True
    return False


@uncounted(error_model="numpy")
def _sees_past_all_about(view, depth, model, u, v, ou, ov):
    """Whether all that is about a pixel (u, v) and the one beside it or itself, (ou, ov), is explained or farther."""
    least = -model[v, u]
    for nv in range(min(v, ov) - 1, max(v, ov) + 2):
        for nu in range(min(u, ou) - 1, max(u, ou) + 2):
            if is_about((nv, nu), (v, u), (ov, ou)):
                d = depth[nv, nu]
                if not (model[nv, nu] > 0.0 or (is_return(view, d) and d > least)):
                    return False
    return True
