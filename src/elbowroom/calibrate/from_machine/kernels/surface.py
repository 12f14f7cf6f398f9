"""How a measured depth image differs from a drawn surface, and what that says of the pose: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.noise import sigma

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


class DepthError(NamedTuple):
    """What a sensor's depth is taken to be off by, along its kind of depth: bias [m] and scale."""

    bias: float
    scale: float


class Sums(NamedTuple):
    """What is added up, or written, from one image of a surface.

    Fields:
        normal, gradient: (8, 8), (8,) sums of weight J^T J and weight J^T r, r in sigmas; added to.
        counts: (5,) as named above; added to.
        residuals: (height, width) float32, measured minus drawn depth [m] of the pixels that agree; others are left.
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
def compare(view, canvas, measured, error, trust, sums):
    """Adds up normal equations of a camera's pose from one image of a surface.

    Residual: measured minus drawn planar depth, over sigma. With the drawn point p, its normal n and the ray d (z 1),
    a camera that moves by the twist (w, t) in its own frame changes the drawn depth by -n.(w x p + t) / n.d. The sensor
    reads (1 + scale) times the true distance plus bias. Unknowns: w, t, bias, scale.

    Args:
        view: the camera.
        canvas: the surface as `machine.kernels.draw.draw` draws it.
        measured: (height, width) float32 planar depth [m], 0 without return.
        error: of the sensor's depth.
        trust: which pixels count.
        sums: added to.

    Returns:
        Tukey's cost: half squares of sigmas, bounded, over all pixels judged that have a return.
    """
    row = np.empty(8)
    cost, limit = 0.0, trust.reach * trust.reach / 6.0
    inverse, counts = canvas.inverse, sums.counts
    for v in range(view.height):
        y = (v - view.cy) / view.fy
        for u in range(canvas.first[v], canvas.last[v] + 1):
            w = float(inverse[v, u])
            if w == 0.0 or not is_smooth(inverse, u, v, trust.border, trust.step_m):
                continue
            x = (u - view.cx) / view.fx
            qx, qy, qz, slope = _plane_through(view, inverse, u, v, x, y)
            length = math.sqrt(x * x + y * y + 1.0)
            if w < trust.least_cosine * length * math.sqrt(qx * qx + qy * qy + qz * qz):
                continue
            counts[SEEN] += 1
            z = float(measured[v, u])
            if not z > 0.0:
                counts[SILENT] += 1
                continue
            drawn, stretch = 1.0 / w, length if view.radial else 1.0
            spread = _spread(view, drawn, stretch, slope, trust)
            off = z - drawn * (1.0 + error.scale) - error.bias / stretch
            r = off / spread
            if abs(r) >= trust.reach:
                counts[BEHIND if r > 0 else BEFORE] += 1
                cost += limit
                continue
            counts[AGREES] += 1
            sums.residuals[v, u] = off
            inside = 1.0 - (r / trust.reach) ** 2
            cost += limit * (1.0 - inside**3)
            # d(drawn)/d(twist) = -(p x n, n) / (n.d); n / (n.d) = q / w; r falls as drawn grows
            px, py = x * drawn, y * drawn
            by = drawn * (1.0 + error.scale) / spread
            row[0] = (py * qz - drawn * qy) * by
            row[1] = (drawn * qx - px * qz) * by
            row[2] = (px * qy - py * qx) * by
            row[3], row[4], row[5] = qx * by, qy * by, qz * by
            row[6], row[7] = -1.0 / (stretch * spread), -drawn / spread
            _add(row, r, inside * inside, sums.normal, sums.gradient)
    return cost


@njit(nogil=True, error_model="numpy")
def _plane_through(view, inverse, u, v, x, y):
    """The plane q.p = 1 through a drawn pixel, ray (x, y, 1), and how steeply inverse depth changes there [1/m px]."""
    across = 0.5 * (float(inverse[v, u + 1]) - float(inverse[v, u - 1]))
    down = 0.5 * (float(inverse[v + 1, u]) - float(inverse[v - 1, u]))
    qx, qy = across * view.fx, down * view.fy
    return qx, qy, float(inverse[v, u]) - x * qx - y * qy, math.sqrt(across * across + down * down)


@njit(nogil=True, error_model="numpy")
def _spread(view, drawn, stretch, slope, trust):
    """Sigma of a residual [m]: noise of the sensor, of the model, of the ray's direction, and of a rough pose.

    stretch: depth of the camera's kind per planar depth.
    """
    noise = sigma(view, drawn * stretch) / stretch
    lateral = trust.lateral_px * slope * drawn * drawn
    return math.sqrt(noise * noise + trust.floor_m**2 + lateral * lateral + trust.widening_m**2)


@njit(nogil=True, error_model="numpy")
def _add(row, r, weight, normal, gradient):
    """Adds one residual's equations."""
    for i in range(8):
        gradient[i] += weight * row[i] * r
        for j in range(8):
            normal[i, j] += weight * row[i] * row[j]
