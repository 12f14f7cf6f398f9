"""What two depth images of one place say of the two cameras' poses: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.noise import sigma
from elbowroom.geometry.kernels.pinhole import pixel_of, ray_of
from elbowroom.geometry.kernels.rigid import moved, turned

NEAREST_M = 0.05
"""Points nearer to the other camera's plane are not compared [m]."""
COMPARED, AGREES, HIDDEN, CONFLICT = 0, 1, 2, 3
"""Columns of counts: points compared, of them in agreement, farther than the image, nearer than the image."""


class Overlap(NamedTuple):
    """Which points count, and how much.

    gate_m: points off by more do not count; from there inwards they count by Tukey's biweight [m].
    reach: the same in sigmas; the wider of both holds.
    floor_m: sigma that is left however good the sensors are [m].
    least_cosine: of the angle between the two normals.
    tiles: the other image is cut into tiles x tiles, whose sums are kept apart.
    arm_px: root of the sum of squared distances of a window's pixels from its middle column: the longer, the less a
        plane's slope suffers from noise [px].
    """

    gate_m: float
    reach: float
    floor_m: float
    least_cosine: float
    tiles: int
    arm_px: float


class Points(NamedTuple):
    """Points with normals away from the camera and sigma along them [m], frame of their camera, shapes (n, 3), (n,)."""

    points: np.ndarray
    normals: np.ndarray
    sigmas: np.ndarray


class Surface(NamedTuple):
    """A planar depth image (height, width) float32 [m], 0 without return, and what `fit_planes` made of it."""

    depth: np.ndarray
    planes: np.ndarray


class Sums(NamedTuple):
    """What is added up from points of one camera in images of another.

    Fields:
        normal, gradient: (tiles^2, 6, 6), (tiles^2, 6).
        by_noise: (6, 6), the part of `normal` that stems from noise in the planes' slopes alone: a flat wall, whose
            normals scatter, would seem to say something of shifts along itself.
        counts: (4,) as named above.
    """

    normal: np.ndarray
    gradient: np.ndarray
    by_noise: np.ndarray
    counts: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def fit_planes(depth, lens, half, bend, planes):
    """A plane q.p = 1 about each pixel of a planar depth image, where its neighbourhood is one surface.

    In a pinhole image the inverse depth of a plane is linear in column and row: (2 half + 1)^2 pixels are fitted.

    Args:
        depth: (height, width) float32 [m], 0 without return.
        lens: any record with the camera's fx, fy, cx and cy [px].
        half: half the window [px].
        bend: a pixel farther than this share of its depth from the middle's depth or from the fit breaks the surface.
        planes: (height, width, 3) float32, q in the camera's frame [1/m]; zeros where there is no plane.
    """
    height, width = depth.shape
    for v in range(half, height - half):
        for u in range(half, width - half):
            n, w0, wu, wv = _slopes(depth, u, v, half, bend)
            if n < (2 * half + 1) ** 2 or _misfit(depth, u, v, half, w0, wu, wv) > bend * w0:
                continue
            x, y = ray_of(lens, u, v)
            qx, qy = wu * lens.fx, wv * lens.fy
            planes[v, u, 0], planes[v, u, 1], planes[v, u, 2] = qx, qy, w0 - x * qx - y * qy


@njit(nogil=True, error_model="numpy")
def _slopes(depth, u, v, half, bend):
    """How many pixels of a window are about as deep as its middle; fitted to them, inverse depth and its two slopes."""
    side = 2 * half + 1
    across = side * half * (half + 1) * side / 3.0
    total, by_u, by_v, n = 0.0, 0.0, 0.0, 0
    middle = depth[v, u]
    if not middle > 0.0:
        return n, 0.0, 0.0, 0.0
    for dv in range(-half, half + 1):
        for du in range(-half, half + 1):
            z = depth[v + dv, u + du]
            if z > 0.0 and abs(z - middle) < 3.0 * bend * middle:
                w = 1.0 / z
                n += 1
                total += w
                by_u += du * w
                by_v += dv * w
    return n, total / n, by_u / across, by_v / across


@njit(nogil=True, error_model="numpy")
def _misfit(depth, u, v, half, w0, wu, wv):
    """How far inverse depth scatters about what the slopes say of the window [1/m]."""
    worst, n = 0.0, (2 * half + 1) ** 2
    for dv in range(-half, half + 1):
        for du in range(-half, half + 1):
            off = 1.0 / depth[v + dv, u + du] - (w0 + du * wu + dv * wv)
            worst += off * off
    return math.sqrt(worst / n)


@njit(cache=True, nogil=True, error_model="numpy")
def compare_points(view, surface, points, other_from_one, rule, sums, offs):
    """Adds up normal equations of the twist of one camera relative to another from points of the one.

    Residual: distance of the point from the plane about the pixel that looks at it, over sigma. With the point p in
    the other's frame and the plane's normal n, a twist (w, t) of the points in that frame changes it by n.(w x p + t).

    Args:
        view: the other camera.
        surface: its image.
        points: of the one camera.
        other_from_one: (4, 4).
        rule: which points count.
        sums: added to.
        offs: (n,) distance from the plane [m] of points that count; others are left.
    """
    row, counts = np.empty(6), sums.counts
    for i in range(points.sigmas.size):
        p = moved(other_from_one, points.points[i, 0], points.points[i, 1], points.points[i, 2])
        if not p[2] > NEAREST_M:
            continue
        u, v = pixel_of(view, p[0], p[1], p[2])
        if not (u >= 0.0 and v >= 0.0 and u <= view.width - 1.0 and v <= view.height - 1.0):
            continue
        column, line = int(u + 0.5), int(v + 0.5)
        q = surface.planes[line, column]
        length = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
        if length == 0.0:
            continue
        n = q[0] / length, q[1] / length, q[2] / length
        a, b, c = turned(other_from_one, points.normals[i, 0], points.normals[i, 1], points.normals[i, 2])
        facing = n[0] * a + n[1] * b + n[2] * c
        counts[COMPARED] += 1
        z = float(surface.depth[line, column])
        off = (q[0] * p[0] + q[1] * p[1] + q[2] * p[2] - 1.0) / length
        spread, tilt = _noise(view, n, column, line, z, rule)
        spread = math.sqrt(
            spread * spread + points.sigmas[i] * points.sigmas[i] + rule.floor_m * rule.floor_m
        )
        limit = max(rule.gate_m, rule.reach * spread)
        if abs(off) >= limit or facing < rule.least_cosine:
            counts[HIDDEN if p[2] > z else CONFLICT] += 1
            continue
        counts[AGREES] += 1
        offs[i] = off
        inside = 1.0 - (off / limit) ** 2
        weight = inside * inside / (spread * spread)
        row[0], row[1], row[2] = (
            p[1] * n[2] - p[2] * n[1],
            p[2] * n[0] - p[0] * n[2],
            p[0] * n[1] - p[1] * n[0],
        )
        row[3], row[4], row[5] = n
        tile = (line * rule.tiles // view.height) * rule.tiles + column * rule.tiles // view.width
        _add(row, off, weight, sums.normal[tile], sums.gradient[tile])
        _add_noise(row, p, weight * tilt * tilt, sums.by_noise)


@njit(nogil=True, error_model="numpy")
def _noise(view, n, column, line, z, rule):
    """Sigma of a pixel's depth z along the normal of its plane [m], and of the plane's slope."""
    x, y = ray_of(view, column, line)
    length = math.sqrt(x * x + y * y + 1.0)
    noise = sigma(view, z * (length if view.radial else 1.0))
    return noise * (abs(n[0] * x + n[1] * y + n[2]) / length), noise * view.fx / (z * rule.arm_px)


@njit(nogil=True, error_model="numpy")
def _add(row, off, weight, normal, gradient):
    """Adds one residual's equations to those of a tile."""
    for j in range(6):
        gradient[j] += weight * row[j] * off
        for k in range(6):
            normal[j, k] += weight * row[j] * row[k]


@njit(nogil=True, error_model="numpy")
def _add_noise(row, p, weight, by_noise):
    """Adds what noise in a plane's slope makes of one residual's equations: over two axes along the surface.

    The sum over three axes less that along the normal, which `row` is of.
    """
    for j in range(6):
        for k in range(6):
            by_noise[j, k] -= weight * row[j] * row[k]
    for axis in range(3):
        # unit vector e: (p x e, e)
        row[:] = 0.0
        row[3 + axis] = 1.0
        if axis == 0:
            row[1], row[2] = p[2], -p[1]
        elif axis == 1:
            row[0], row[2] = -p[2], p[0]
        else:
            row[0], row[1] = p[1], -p[0]
        for j in range(6):
            for k in range(6):
                by_noise[j, k] += weight * row[j] * row[k]
