"""Compares measured depth images with the drawn machine: which pixels are the machine. Arrays in, arrays out."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.neighbours import is_about
from elbowroom.machine.kernels.returns import (
    MOST_M,
    UNSAFE,
    Scratch,
    has_support,
    is_return,
    mark_row_of_tiles,
    set_run,
)


class Tolerance(NamedTuple):
    """A depth d fits if it lies within `metres` + `sigmas` * sigma(d) of what is drawn."""

    metres: float
    sigmas: float


@njit(cache=True, nogil=True, error_model="numpy")
def explain(view, depth, drawn, tolerance, model, around):
    """Fills `model` where a measured depth fits what was drawn in the 3 x 3 pixels about it; wipes what was drawn.

    Sets the voxels of the returns that do not fit, too.

    Args:
        view: the camera.
        depth: (height, width) float32, measured [m, the camera's kind].
        drawn: `Drawn`, from `draw` and `to_kind`: inverse depth of the camera's kind; zeros afterwards.
        tolerance: `Tolerance`.
        model: (height, width) float32 zeros; where a pixel fits, the depth drawn in it, or else nearest about it
            [m, same kind]. Of a camera whose pixels fly, also what `_settle_edges` says.
        around: where to look for other returns, and the plane for their voxels; without tiles: nowhere.
    """
    inverse, first, last = drawn
    height, width = view.height, view.width
    left, right = width, -1
    for v in range(height):
        left, right = min(left, first[v]), max(right, last[v])
    left, right = max(0, left - 1), min(width - 1, right + 1)
    # for each of three rows: greatest and least inverse depth of a pixel and its neighbours
    across = np.zeros((8, width + 2), dtype=np.float32)
    # above the first row is nothing
    across[3:6] = np.inf
    limits = np.empty((2, width), dtype=np.float32)
    found = np.zeros((width + 7) // 8 * 8, dtype=np.uint8)
    spans, boxes = np.empty((3, width), dtype=np.float32), np.empty((6, width), dtype=np.int32)
    scratch = Scratch(limits, found, spans, boxes)
    for v in range(-1, height):
        _across(inverse, v + 1, first, last, left, right, across, (v + 1) % 3)
        if v < 0:
            continue
        start, stop = width, -1
        for row in range(max(0, v - 1), min(height, v + 2)):
            start, stop = min(start, first[row]), max(stop, last[row])
        if stop >= 0:
            start, stop = max(0, start - 1), min(width - 1, stop + 1)
            _compare(view, depth[v], inverse[v], across, (start, stop), tolerance, model[v])
    if view.flying:
        _settle_edges(view, depth, first, last, model)
    for row in range(around.near.shape[0]):
        mark_row_of_tiles(view, depth, model, row, around, scratch)
    for v in range(height):
        set_run(inverse[v], first[v], last[v] + 1, np.float32(0.0))


@njit(nogil=True, error_model="numpy")
def _across(inverse, v, first, last, left, right, across, row):
    """Greatest (row) and least (row + 3) inverse depth of each pixel of image row v and its two neighbours.

    Zero and infinity where there is none. Column u of the image is column u + 1 of `across`.
    """
    most, least = across[row], across[row + 3]
    set_run(most, left, right + 3, np.float32(0.0))
    set_run(least, left, right + 3, np.float32(np.inf))
    if v < inverse.shape[0] and last[v] >= 0:
        _of_neighbours(inverse[v], first[v], last[v], across[6], across[7], most, least)


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
def _compare(view, depth, drawn, across, span, tolerance, model):
    """Fills a span of one row of the model where depth fits; without branches, for many pixels at once."""
    start, stop = span
    metres, sigmas = tolerance
    one, zero = np.float32(1.0), np.float32(0.0)
    fixed, factor = np.float32(metres + sigmas * view.constant), np.float32(sigmas * view.linear)
    square, offset = np.float32(sigmas * view.quadratic), np.float32(view.offset)
    low, high = np.float32(view.min_depth), np.float32(min(view.max_depth, MOST_M))
    flying = view.flying
    # unsigned indices, or the compiler does one pixel at a time
    for n in range(start, stop + 1):
        u = np.uint64(n)
        after = u + np.uint64(1)
        nearest = max(across[0, after], max(across[1, after], across[2, after]))
        farthest = min(across[3, after], min(across[4, after], across[5, after]))
        d = depth[u]
        beyond = max(d - offset, zero)
        slack = fixed + factor * d + square * beyond * beyond
        valid = (d > zero) & (d >= low) & (d <= high)
        fits = valid & (nearest > zero) & ((d + slack) * nearest >= one) & ((d - slack) * farthest <= one)
        # behind the model's nearest surface and beside it: perhaps a mixed pixel of its edge (`_settle_edges`)
        # up to the surface drawn in the pixel itself; beside the drawn edge up to the nearest one about it
        free_to = one / (drawn[u] if drawn[u] > zero else nearest)
        unfit = -free_to if flying & (nearest > zero) else zero
        model[u] = free_to if fits else unfit


@njit(nogil=True, error_model="numpy")
def _settle_edges(view, depth, first, last, model):
    """Pixels that the model is about without fitting, below zero on entry by the depth that the model frees.

    Those that see past the machine's edge and stand alone are mixed pixels of the edge: explained, infinity. Others
    about which all is explained or farther are specks, and explained as well: they stay below zero. The rest becomes
    `UNSAFE`.
    """
    for turn in range(3):
        for v in range(view.height):
            start, stop = view.width, -1
            for row in range(max(0, v - 1), min(view.height, v + 2)):
                start, stop = min(start, first[row]), max(stop, last[row])
            for u in range(max(0, start - 1), min(view.width - 1, stop + 1) + 1 if stop >= 0 else 0):
                if model[v, u] >= 0.0:
                    continue
                if turn == 0:
                    # with another mark first, so that all are judged by the same neighbours
                    d = depth[v, u]
                    past = is_return(view, d) and d > -model[v, u]
                    if past and not has_support(view, depth, model, u, v):
                        model[v, u] = -np.inf
                elif turn == 1:
                    if model[v, u] == -np.inf:
                        model[v, u] = np.inf
                elif not _is_speck(view, depth, model, u, v):
                    model[v, u] = UNSAFE


@njit(nogil=True, error_model="numpy")
def _is_speck(view, depth, model, u, v):
    """Whether all neighbours of a pixel, or of it and one beside it, are explained or see past the model in it."""
    least = -model[v, u]
    for dv in range(-1, 2):
        for du in range(-1, 2):
            ov, ou = v + dv, u + du
            if not (0 < v < view.height - 1 and 0 < u < view.width - 1):
                return False
            if not (0 < ov < view.height - 1 and 0 < ou < view.width - 1):
                continue
            clear = True
            for nv in range(min(v, ov) - 1, max(v, ov) + 2):
                for nu in range(min(u, ou) - 1, max(u, ou) + 2):
                    if is_about((nv, nu), (v, u), (ov, ou)):
                        d = depth[nv, nu]
                        clear &= model[nv, nu] > 0.0 or (is_return(view, d) and d > least)
            if clear:
                return True
    return False
