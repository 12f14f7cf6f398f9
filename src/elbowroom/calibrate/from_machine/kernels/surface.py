"""How a measured depth image differs from a drawn surface, and what that says of the pose: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

SEEN, AGREES, BEHIND, BEFORE, SILENT = 0, 1, 2, 3, 4
"""Columns of counts: pixels of the surface judged, of them in agreement, farther, nearer, without return."""


class Trust(NamedTuple):
    """Which pixels count, and how much.

    border: pixels this near to a step of the drawn surface do not count [px].
    step_m: what counts as a step [m].
    least_cosine: of the angle between ray and normal; flatter pixels do not count.
    floor_m: sigma of the model itself [m].
    lateral_px: sigma of the ray's direction [px].
    widening_m: added to sigma while the pose is still rough [m].
    reach: pixels off by this many sigmas count nothing (Tukey's biweight).
    """

    border: int
    step_m: float
    least_cosine: float
    floor_m: float
    lateral_px: float
    widening_m: float
    reach: float


class Sums(NamedTuple):
    """What `compare` adds up of one image.

    normal, gradient: (8, 8), (8,) sums of weight J^T J and weight J^T r, r in sigmas. counts: (5,) as named above.
    residuals: (height, width) float32, measured minus drawn depth [m] of the pixels that agree; NaN elsewhere.
    """

    normal: np.ndarray
    gradient: np.ndarray
    counts: np.ndarray
    residuals: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def is_smooth(inverse, u, v, border, step_m):
    """Whether the drawn surface about a pixel is one piece: along eight directions inverse depth is nearly linear."""
    height, width = inverse.shape
    if u < border or v < border or u >= width - border or v >= height - border:
        return False
    middle = inverse[v, u]
    allowed = step_m * middle * middle
    for far in range(1, border + 1):
        for du, dv in ((far, 0), (0, far), (far, far), (far, -far)):
            one, two = inverse[v + dv, u + du], inverse[v - dv, u - du]
            if one == 0.0 or two == 0.0 or abs(one + two - 2.0 * middle) > allowed:
                return False
            if abs(one - two) > 8.0 * far * allowed:
                return False
    return True


@njit(cache=True, nogil=True, error_model="numpy")
def compare(view, drawn_in, measured, depth_error, trust, sums):
    """Adds up normal equations of a camera's pose from one image of a surface.

    Residual: measured minus drawn planar depth, over sigma. With the drawn point p, its normal n and the ray d (z 1),
    a camera that moves by the twist (w, t) in its own frame changes the drawn depth by -n.(w x p + t) / n.d. The sensor
    reads (1 + scale) times the true distance plus bias. Unknowns: w, t, bias, scale.

    Args:
        view: the camera.
        drawn_in: `Drawn`: 1 / drawn planar depth, and which columns of each row it is in.
        measured: (height, width) float32 planar depth [m], 0 without return.
        depth_error: bias and scale that the sensor's depth is taken to be off by [m, 1], along its kind of depth.
        trust: which pixels count.
        sums: `Sums`, added to.

    Returns:
        Tukey's cost: half squares of sigmas, bounded, over all pixels judged that have a return.
    """
    inverse, first, last = drawn_in
    bias, scale = depth_error
    normal, gradient, counts, residuals = sums
    row = np.empty(8)
    cost = 0.0
    limit = trust.reach * trust.reach / 6.0
    for v in range(view.height):
        y = (v - view.cy) / view.fy
        for u in range(first[v], last[v] + 1):
            w = float(inverse[v, u])
            if w == 0.0 or not is_smooth(inverse, u, v, trust.border, trust.step_m):
                continue
            x = (u - view.cx) / view.fx
            # the plane q.p = 1 through the drawn point, from the slope of inverse depth
            across = 0.5 * (float(inverse[v, u + 1]) - float(inverse[v, u - 1]))
            down = 0.5 * (float(inverse[v + 1, u]) - float(inverse[v - 1, u]))
            qx, qy = across * view.fx, down * view.fy
            qz = w - x * qx - y * qy
            length = math.sqrt(x * x + y * y + 1.0)
            if w < trust.least_cosine * length * math.sqrt(qx * qx + qy * qy + qz * qz):
                continue
            counts[SEEN] += 1
            z = float(measured[v, u])
            if not z > 0.0:
                counts[SILENT] += 1
                continue
            drawn = 1.0 / w
            stretch = length if view.radial else 1.0
            beyond = max(drawn * stretch - view.offset, 0.0)
            sigma = (
                view.constant + view.linear * drawn * stretch + view.quadratic * beyond * beyond
            ) / stretch
            slope = trust.lateral_px * math.sqrt(across * across + down * down) * drawn * drawn
            sigma = math.sqrt(sigma * sigma + trust.floor_m**2 + slope * slope + trust.widening_m**2)
            off = z - drawn * (1.0 + scale) - bias / stretch
            r = off / sigma
            if abs(r) >= trust.reach:
                counts[BEHIND if r > 0 else BEFORE] += 1
                cost += limit
                continue
            counts[AGREES] += 1
            residuals[v, u] = off
            inside = 1.0 - (r / trust.reach) ** 2
            cost += limit * (1.0 - inside**3)
            weight = inside * inside
            # d(drawn)/d(twist) = -(p x n, n) / (n.d); n / (n.d) = q / w; r falls as drawn grows
            px, py = x * drawn, y * drawn
            by = drawn * (1.0 + scale) / sigma
            row[0] = (py * qz - drawn * qy) * by
            row[1] = (drawn * qx - px * qz) * by
            row[2] = (px * qy - py * qx) * by
            row[3], row[4], row[5] = qx * by, qy * by, qz * by
            row[6], row[7] = -1.0 / (stretch * sigma), -drawn / sigma
            for i in range(8):
                gradient[i] += weight * row[i] * r
                for j in range(8):
                    normal[i, j] += weight * row[i] * row[j]
    return cost
