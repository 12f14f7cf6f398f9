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
            view, depth, canvas, model, np.empty(width, dtype=np.uint8), np.empty(width, dtype=np.uint8)
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
def _settle_edges(view, depth, canvas, model, counts, marks):
    """Pixels that the model is about without fitting, below zero on entry by the depth that the model frees.

    Those that see past the machine's edge and stand alone are mixed pixels of the edge: explained, infinity. Those that
    see past it, but not at its edge, and do not stand alone are `UNSAFE`: a surface behind the model's, so the model is
    larger than the machine, or the machine is not there. Others about which all is explained or farther are specks, and
    explained as well: they stay below zero. The rest becomes `UNSAFE`.

    Args:
        view, depth, canvas, model: as of `explain`.
        counts, marks: (width,) uint8 each, room to work in.
    """
    for turn in range(3):
        for v in range(view.height):
            first, last = _columns_about(canvas, v - 1, v + 2)
            signs, within = model[v].view(np.uint32), 0 < v < view.height - 1
            # most runs of pixels hold none that is below zero
            for start in range(first, last + 1, RUN):
                stop = min(start + RUN, last + 1)
                if not _any_below_zero(signs, start, stop):
                    continue
                if turn == 1:
                    _explain_alone(model[v], start, stop)
                    continue
                # those that have eight neighbours many at once, others one by one
                inner, end = max(start, 1), min(stop, view.width - 1)
                if not within:
                    inner, end = stop, stop
                elif turn == 0:
                    _settle_past(view, depth, canvas, model, (inner, v), end, counts, marks)
                else:
                    _settle_near(view, depth, model, (inner, v), end, counts, marks)
                for u in range(start, inner):
                    _settle_edge(view, depth, model, (u, v, turn))
                for u in range(end, stop):
                    _settle_edge(view, depth, model, (u, v, turn))


@uncounted()
def _any_below_zero(signs, start, stop):
    """Whether any of a run of float32 numbers, as bits, has a sign."""
    some = np.uint32(0)
    for n in range(start, stop):
        some |= signs[np.uint64(n)]
    return some >> np.uint32(31) != 0


@uncounted()
def _explain_alone(freed, start, stop):
    """Makes those of a run of pixels explained, infinity, that are marked as mixed pixels of the machine's edge."""
    most = np.float32(np.inf)
    for n in range(start, stop):
        u = np.uint64(n)
        freed[u] = most if freed[u] == -most else freed[u]


@uncounted(error_model="numpy")
def _settle_past(view, depth, canvas, model, at, stop, counts, marks):
    """The first turn of `_settle_edges` for pixels of a run that have eight neighbours, many at once.

    What becomes of a pixel is marked as minus infinity at first, so that all are judged by the same neighbours.

    Args:
        view, depth, canvas, model: as of `explain`.
        at: first column of the run, its row.
        stop: one past its last column.
        counts, marks: as of `_settle_edges`.
    """
    start, v = at
    d, freed = depth[v], model[v]
    if not _mark_past(view, d, freed, start, stop, marks):
        return
    _count_like(
        view,
        Three(depth[v - 1], d, depth[v + 1]),
        Three(model[v - 1], freed, model[v + 1]),
        start,
        stop,
        counts,
    )
    drawn = Three(canvas.inverse[v - 1], canvas.inverse[v], canvas.inverse[v + 1])
    _mark_within(drawn, start, stop, marks)
    enough, alone = np.uint8(SUPPORT), np.float32(-np.inf)
    for n in range(start, stop):
        u = np.uint64(n)
        past, inside = marks[u] & np.uint8(1) != 0, marks[u] & np.uint8(2) != 0
        supported = alone if counts[u] < enough else UNSAFE if inside else freed[u]
        freed[u] = supported if past else freed[u]


@uncounted(error_model="numpy")
def _mark_past(view, depth, freed, start, stop, marks):
    """Marks with 1 the pixels of a run that are below zero and see past what the model frees, others 0; whether any."""
    low, high, some = least_from(view.min_depth), most_to(min(view.max_depth, MOST_M)), np.uint8(0)
    for n in range(start, stop):
        u = np.uint64(n)
        d = depth[u]
        past = (
            (freed[u] < np.float32(0.0)) & (d > np.float32(0.0)) & (d >= low) & (d <= high) & (d > -freed[u])
        )
        marks[u] = np.uint8(past)
        some |= marks[u]
    return some != 0


@uncounted(error_model="numpy")
def _mark_within(drawn, start, stop, marks):
    """Marks with 2 as well the pixels of a run that lie within the model: they and all about them are drawn."""
    for n in range(start, stop):
        u = np.uint64(n)
        left, right = u - np.uint64(1), u + np.uint64(1)
        above = min(drawn.above[left], min(drawn.above[u], drawn.above[right]))
        here = min(drawn.here[left], min(drawn.here[u], drawn.here[right]))
        below = min(drawn.below[left], min(drawn.below[u], drawn.below[right]))
        marks[u] |= np.uint8(2) if min(above, min(here, below)) > np.float32(0.0) else np.uint8(0)


@uncounted(error_model="numpy")
def _settle_near(view, depth, model, at, stop, counts, marks):
    """The last turn of `_settle_edges` for pixels of a run that have eight neighbours, many at once.

    Args:
        view, depth, model, counts, marks: as of `_settle_edges`.
        at: first column of the run, its row.
        stop: one past its last column.
    """
    start, v = at
    freed, zero, some = model[v], np.float32(0.0), np.uint8(0)
    _count_near(
        view,
        Three(depth[v - 1], depth[v], depth[v + 1]),
        Three(model[v - 1], freed, model[v + 1]),
        start,
        stop,
        counts,
    )
    for n in range(start, stop):
        u = np.uint64(n)
        open_ = (freed[u] < zero) & (freed[u] != UNSAFE)
        freed[u] = UNSAFE if open_ & (counts[u] >= np.uint8(2)) else freed[u]
        marks[u] = np.uint8(open_ & (counts[u] == np.uint8(1)))
        some |= marks[u]
    if some != 0:
        for u in range(start, stop):
            if marks[u] != 0 and not _is_speck_of_two(view, depth, model, u, v):
                freed[u] = UNSAFE


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
def _settle_edge(view, depth, model, at):
    """The first or last turn of `_settle_edges` for one pixel at the image's border.

    Args:
        view, depth, model: as of `explain`.
        at: its column, its row, the turn.
    """
    u, v, turn = at
    if not model[v, u] < 0.0:
        return
    if turn == 0:
        d = depth[v, u]
        if is_return(view, d) and d > -model[v, u] and not has_support(view, depth, model, u, v):
            model[v, u] = -np.inf
    else:
        model[v, u] = UNSAFE


@uncounted(error_model="numpy")
def _is_speck_of_two(view, depth, model, u, v):
    """Whether all neighbours of a pixel and one beside it are explained or see past the model in it."""
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
