"""Compares measured depth images with the drawn machine: which pixels are the machine. Arrays in, arrays out."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.neighbours import is_about
from elbowroom.geometry.kernels.noise import sigma
from elbowroom.machine.kernels.returns import (
    MOST_M,
    UNSAFE,
    Scratch,
    has_support,
    is_return,
    mark_row_of_tiles,
    set_run,
    spread_of,
)

RUN = 64
"""Pixels of a row that are looked over before they are worked on."""


class Tolerance(NamedTuple):
    """How far a measured depth d may be from the model and still be the machine's: metres + sigmas * sigma(d)."""

    metres: float
    sigmas: float


@njit(cache=True, nogil=True, error_model="numpy")
def explain(view, depth, canvas, tolerance, model, around):
    """Fills `model` where a measured depth fits what was drawn in the 3 x 3 pixels about it; wipes the canvas' image.

    Sets the voxels of the returns that do not fit, too.

    Args:
        view: the camera.
        depth: (height, width) float32, measured [m, the camera's kind].
        canvas: from `draw` and `to_kind`; its image is zeros afterwards.
        tolerance: how near is near enough.
        model: (height, width) float32 zeros; where a pixel fits, the depth drawn in it, or else nearest about it
            [m, same kind]. Of a camera whose pixels fly, also what `_settle_edges` says.
        around: where to look for other returns, and the plane for their voxels; without tiles: nowhere.
    """
    height, width = view.height, view.width
    left, right = _columns_about(canvas, 0, height)
    # for each of three rows: greatest and least inverse depth of a pixel and its neighbours
    across = np.zeros((8, width + 2), dtype=np.float32)
    # above the first row is nothing
    across[3:6] = np.inf
    for v in range(-1, height):
        _across(canvas, v + 1, left, right, across)
        if v < 0:
            continue
        start, stop = _columns_about(canvas, v - 1, v + 2)
        if start <= stop:
            _compare(view, depth[v], canvas.inverse[v], across, start, stop, tolerance, model[v])
    if view.flying:
        _settle_edges(view, depth, canvas, model)
    scratch = Scratch(
        np.empty((2, width), dtype=np.float32),
        np.zeros((width + 7) // 8 * 8, dtype=np.uint8),
        np.empty((3, width), dtype=np.float32),
        np.empty((6, width), dtype=np.int32),
    )
    for row in range(around.near.shape[0]):
        mark_row_of_tiles(view, depth, model, row, around, scratch)
    for v in range(height):
        set_run(canvas.inverse[v], canvas.first[v], canvas.last[v] + 1, np.float32(0.0))


@njit(nogil=True)
def _columns_about(canvas, above, below):
    """First and last column drawn in the rows from `above` up to `below`, or beside one; if none is, 0 and -1."""
    first, last, width = canvas.first, canvas.last, canvas.inverse.shape[1]
    start, stop = width, -1
    for row in range(max(0, above), min(first.size, below)):
        start, stop = min(start, first[row]), max(stop, last[row])
    if stop < 0:
        return 0, -1
    return max(0, start - 1), min(width - 1, stop + 1)


@njit(nogil=True, error_model="numpy")
def _across(canvas, v, left, right, across):
    """Greatest and least inverse depth of each pixel of image row v and its two neighbours.

    They go into row v % 3 of `across` and the third after it: zero and infinity where there is none. Column u of the
    image is column u + 1 of `across`. Rows 6 and 7 are scratch.
    """
    most, least = across[v % 3], across[v % 3 + 3]
    set_run(most, left, right + 3, np.float32(0.0))
    set_run(least, left, right + 3, np.float32(np.inf))
    if v < canvas.inverse.shape[0] and canvas.last[v] >= 0:
        first, last = canvas.first[v], canvas.last[v]
        _of_neighbours(canvas.inverse[v], first, last, across[6], across[7], most, least)


@njit(nogil=True, error_model="numpy")
def _of_neighbours(drawn, first, last, padded, filled, most, least):
    """Greatest and least of three neighbours; `padded` takes what was drawn, `filled` has infinity for 0."""
    start, stop = max(0, first - 1), min(drawn.size - 1, last + 1)
    one, two, zero, far = np.uint64(1), np.uint64(2), np.float32(0.0), np.float32(np.inf)
    set_run(padded, start, stop + 3, zero)
    for n in range(first, last + 1):
        u = np.uint64(n)
        padded[u + one] = drawn[u]
    for n in range(start, stop + 3):
        u = np.uint64(n)
        filled[u] = padded[u] if padded[u] > zero else far
    for n in range(start, stop + 1):
        u = np.uint64(n)
        most[u + one] = max(padded[u], max(padded[u + one], padded[u + two]))
    for n in range(start, stop + 1):
        u = np.uint64(n)
        least[u + one] = min(filled[u], min(filled[u + one], filled[u + two]))


@njit(nogil=True, error_model="numpy")
def _compare(view, depth, drawn, across, start, stop, tolerance, model):
    """Fills one row of the model where depth fits; without branches, for many pixels at once."""
    one, zero = np.float32(1.0), np.float32(0.0)
    spread = spread_of(view, tolerance.sigmas, tolerance.metres)
    low, high = np.float32(view.min_depth), np.float32(min(view.max_depth, MOST_M))
    flying = view.flying
    # unsigned indices, or the compiler does one pixel at a time
    for n in range(start, stop + 1):
        u = np.uint64(n)
        after = u + np.uint64(1)
        nearest = max(across[0, after], max(across[1, after], across[2, after]))
        farthest = min(across[3, after], min(across[4, after], across[5, after]))
        d = depth[u]
        slack = sigma(spread, d)
        valid = (d > zero) & (d >= low) & (d <= high)
        fits = valid & (nearest > zero) & ((d + slack) * nearest >= one) & ((d - slack) * farthest <= one)
        # behind the model's nearest surface and beside it: perhaps a mixed pixel of its edge (`_settle_edges`)
        # up to the surface drawn in the pixel itself; beside the drawn edge up to the nearest one about it
        free_to = one / (drawn[u] if drawn[u] > zero else nearest)
        unfit = -free_to if flying & (nearest > zero) else zero
        model[u] = free_to if fits else unfit


@njit(nogil=True, error_model="numpy")
def _settle_edges(view, depth, canvas, model):
    """Pixels that the model is about without fitting, below zero on entry by the depth that the model frees.

    Those that see past the machine's edge and stand alone are mixed pixels of the edge: explained, infinity. Those that
    see past it, but not at its edge, and do not stand alone are `UNSAFE`: a surface behind the model's, so the model is
    larger than the machine, or the machine is not there. Others about which all is explained or farther are specks, and
    explained as well: they stay below zero. The rest becomes `UNSAFE`.
    """
    for turn in range(3):
        for v in range(view.height):
            first, last = _columns_about(canvas, v - 1, v + 2)
            signs = model[v].view(np.uint32)
            # most runs of pixels hold none that is below zero
            for start in range(first, last + 1, RUN):
                stop = min(start + RUN, last + 1)
                if _any_below_zero(signs, start, stop):
                    for u in range(start, stop):
                        if not model[v, u] >= 0.0:
                            _settle_edge(view, depth, canvas, model, (u, v, turn))


@uncounted()
def _any_below_zero(signs, start, stop):
    """Whether any of a run of float32 numbers, as bits, has a sign."""
    some = np.uint32(0)
    for n in range(start, stop):
        some |= signs[np.uint64(n)]
    return some >> np.uint32(31) != 0


@uncounted(error_model="numpy")
def _settle_edge(view, depth, canvas, model, at):
    """One turn for one pixel of `_settle_edges`; `at`: its column, its row, the turn."""
    u, v, turn = at
    if turn == 0:
        # with another mark first, so that all are judged by the same neighbours
        d = depth[v, u]
        past = is_return(view, d) and d > -model[v, u]
        if past and not has_support(view, depth, model, u, v):
            model[v, u] = -np.inf
        elif past and _is_within(canvas, u, v):
            model[v, u] = UNSAFE
    elif turn == 1:
        if model[v, u] == -np.inf:
            model[v, u] = np.inf
    elif not _is_speck(view, depth, model, u, v):
        model[v, u] = UNSAFE


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
def _is_speck(view, depth, model, u, v):
    """Whether all neighbours of a pixel, or of it and one beside it, are explained or see past the model in it."""
    if not (0 < v < view.height - 1 and 0 < u < view.width - 1) or _two_do_not(view, depth, model, u, v):
        return False
    for ov in range(v - 1, v + 2):
        for ou in range(u - 1, u + 2):
            inside = 0 < ov < view.height - 1 and 0 < ou < view.width - 1
            if inside and _sees_past_all_about(view, depth, model, u, v, ou, ov):
                return True
    return False


@uncounted(error_model="numpy")
def _two_do_not(view, depth, model, u, v):
    """Whether two of the eight pixels about one, all in the image, are neither explained nor farther: then it is no
    speck, with none of its neighbours."""
    least, near = -model[v, u], 0
    for nv in range(v - 1, v + 2):
        for nu in range(u - 1, u + 2):
            d = depth[nv, nu]
            if (nv != v or nu != u) and not (model[nv, nu] > 0.0 or (is_return(view, d) and d > least)):
                near += 1
                if near == 2:
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
