"""Pixels that fly, and those that lost their return: what their neighbours say of how far they are free."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.neighbours import is_about
from elbowroom.geometry.kernels.noise import margin_at
from elbowroom.reconstruct.kernels.texels import NEUTRAL, NEXT_TO_NOTHING_M, free_to_model


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
    keep = 1.0 - pitch
    # three rows of what each pixel would leave free of a speck beside it
    short_of = np.zeros((3, columns), dtype=np.float32)
    farther = np.zeros(columns, dtype=np.int32)
    passed[:] = texels
    for v in range(-1, rows - 1):
        following, row = texels[v + 1], short_of[(v + 1) % 3]
        for n in range(columns):
            u = np.uint64(n)
            row[u] = np.float32(np.int32(following[u] >> np.uint32(16))) * np.float32(keep) - np.float32(0.5)
        if v < 1:
            continue
        _count_farther(texels[v], short_of[(v - 1) % 3], short_of[v % 3], short_of[(v + 1) % 3], farther)
        for u in range(1, columns - 1):
            # only where at least seven of eight neighbours are farther, the pixel can be a speck
            if farther[u] < 7:
                continue
            short = _short_of_neighbours(texels, v, u) * keep - 1.0
            if short > texels[v, u] >> np.uint32(16):
                passed[v, u] = _with_least(texels[v, u], np.uint32(short))
    for v in range(model_m.shape[0]):
        for u in range(columns):
            if model_m[v, u] < 0.0:
                least = texels[v, u] >> np.uint32(16)
                if model_m[v, u] < -NEXT_TO_NOTHING_M:
                    least = max(least, free_to_model(-model_m[v, u], counting))
                passed[v, u] = _with_least(texels[v, u], least)


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
    rows, columns = texels.shape
    three = np.full((3, columns + 2), 0xFFFF, dtype=np.int32)
    nearest = np.full(columns + 2, 0xFFFF, dtype=np.int32)
    for v in range(-1, rows):
        row = three[(v + 1) % 3]
        if v + 1 < rows:
            following, skipped = texels[v + 1], ignored[v + 1]
            for n in range(columns):
                u = np.uint64(n)
                least = np.int32(following[u] >> np.uint32(16))
                row[u + np.uint64(1)] = np.int32(0xFFFF) if skipped[u] == NEUTRAL else least
        else:
            row[:] = 0xFFFF
        if v < 0:
            continue
        here = texels[v]
        for n in range(columns + 2):
            u = np.uint64(n)
            nearest[u] = min(three[0, u], min(three[1, u], three[2, u]))
        out = lowered[v]
        for n in range(columns):
            u = np.uint64(n)
            near = min(nearest[u], min(nearest[u + np.uint64(1)], nearest[u + np.uint64(2)]))
            least = np.int32(here[u] >> np.uint32(16))
            steps = (least - near) * quantum > margin_at(step, least * quantum)
            out[u] = _with_least(here[u], np.uint32(near if steps else least))
