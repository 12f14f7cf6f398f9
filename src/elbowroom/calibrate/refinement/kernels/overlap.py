"""What two depth images of one place say of the two cameras' poses: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

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


class Seen(NamedTuple):
    """Points that one camera saw, (n, 3), their surface's normals, (n, 3), frame of the camera; sigmas, (n,), along
    the normals [m]."""

    points: np.ndarray
    normals: np.ndarray
    sigmas: np.ndarray


class Image(NamedTuple):
    """Another camera's planar depth image [m], and what `fit_planes` made of it."""

    depth: np.ndarray
    planes: np.ndarray


class Sums(NamedTuple):
    """What `compare_points` adds up.

    normal, gradient: (tiles^2, 6, 6), (tiles^2, 6). by_noise: (6, 6), the part of `normal` that stems from noise in
    the planes' slopes alone: a flat wall, whose normals scatter, would seem to say something of shifts along itself.
    counts: (4,) as named above.
    """

    normal: np.ndarray
    gradient: np.ndarray
    by_noise: np.ndarray
    counts: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def fit_planes(depth, fx, fy, cx, cy, half, bend, planes):
    """A plane q.p = 1 about each pixel of a planar depth image, where its neighbourhood is one surface.

    In a pinhole image the inverse depth of a plane is linear in column and row: (2 half + 1)^2 pixels are fitted.

    Args:
        depth: (height, width) float32 [m], 0 without return.
        fx, fy, cx, cy: of the camera [px].
        half: half the window [px].
        bend: a pixel farther than this share of its depth from the middle's depth or from the fit breaks the surface.
        planes: (height, width, 3) float32, q in the camera's frame [1/m]; zeros where there is no plane.
    """
    height, width = depth.shape
    side = 2 * half + 1
    across = side * half * (half + 1) * side / 3.0
    for v in range(half, height - half):
        for u in range(half, width - half):
            middle = depth[v, u]
            if not middle > 0.0:
                continue
            total, by_u, by_v, n = 0.0, 0.0, 0.0, 0
            for dv in range(-half, half + 1):
                for du in range(-half, half + 1):
                    z = depth[v + dv, u + du]
                    if z > 0.0 and abs(z - middle) < 3.0 * bend * middle:
                        w = 1.0 / z
                        n += 1
                        total += w
                        by_u += du * w
                        by_v += dv * w
            if n < side * side:
                continue
            w0, wu, wv = total / n, by_u / across, by_v / across
            worst = 0.0
            for dv in range(-half, half + 1):
                for du in range(-half, half + 1):
                    off = 1.0 / depth[v + dv, u + du] - (w0 + du * wu + dv * wv)
                    worst += off * off
            if math.sqrt(worst / n) > bend * w0:
                continue
            x, y = (u - cx) / fx, (v - cy) / fy
            qx, qy = wu * fx, wv * fy
            planes[v, u, 0], planes[v, u, 1], planes[v, u, 2] = qx, qy, w0 - x * qx - y * qy


@njit(cache=True, nogil=True, error_model="numpy")
def compare_points(view, image, seen, other_from_one, rule, sums, offs):
    """Adds up normal equations of the twist of one camera relative to another from points of the one.

    Residual: distance of the point from the plane about the pixel that looks at it, over sigma. With the point p in
    the other's frame and the plane's normal n, a twist (w, t) of the points in that frame changes it by n.(w x p + t).

    Args:
        view: the other camera.
        image: `Image` of it.
        seen: `Seen` by the one camera.
        other_from_one: (4, 4).
        rule: which points count.
        sums: `Sums`, added to.
        offs: (n,) distance from the plane [m] of points that count, NaN of others.
    """
    depth, planes = image
    points, normals, sigmas = seen
    counts = sums.counts
    row = np.empty(6)
    r = other_from_one
    for i in range(points.shape[0]):
        a, b, c = points[i, 0], points[i, 1], points[i, 2]
        px = r[0, 0] * a + r[0, 1] * b + r[0, 2] * c + r[0, 3]
        py = r[1, 0] * a + r[1, 1] * b + r[1, 2] * c + r[1, 3]
        pz = r[2, 0] * a + r[2, 1] * b + r[2, 2] * c + r[2, 3]
        if not pz > 0.05:
            continue
        u, v = view.fx * px / pz + view.cx, view.fy * py / pz + view.cy
        if not (u >= 0.0 and v >= 0.0 and u <= view.width - 1.0 and v <= view.height - 1.0):
            continue
        column, line = int(u + 0.5), int(v + 0.5)
        qx, qy, qz = planes[line, column, 0], planes[line, column, 1], planes[line, column, 2]
        length = math.sqrt(qx * qx + qy * qy + qz * qz)
        if length == 0.0:
            continue
        nx, ny, nz = qx / length, qy / length, qz / length
        a, b, c = normals[i, 0], normals[i, 1], normals[i, 2]
        facing = nx * (r[0, 0] * a + r[0, 1] * b + r[0, 2] * c)
        facing += ny * (r[1, 0] * a + r[1, 1] * b + r[1, 2] * c)
        facing += nz * (r[2, 0] * a + r[2, 1] * b + r[2, 2] * c)
        counts[COMPARED] += 1
        z = float(depth[line, column])
        off = (qx * px + qy * py + qz * pz - 1.0) / length
        x, y = (column - view.cx) / view.fx, (line - view.cy) / view.fy
        cosine = abs(nx * x + ny * y + nz) / math.sqrt(x * x + y * y + 1.0)
        stretch = math.sqrt(x * x + y * y + 1.0) if view.radial else 1.0
        beyond = max(z * stretch - view.offset, 0.0)
        noise = view.constant + view.linear * z * stretch + view.quadratic * beyond * beyond
        sigma = noise * cosine
        tilt = noise * view.fx / (z * rule.arm_px)
        sigma = math.sqrt(sigma * sigma + sigmas[i] * sigmas[i] + rule.floor_m * rule.floor_m)
        limit = max(rule.gate_m, rule.reach * sigma)
        if abs(off) >= limit or facing < rule.least_cosine:
            if pz > z:
                counts[HIDDEN] += 1
            else:
                counts[CONFLICT] += 1
            continue
        counts[AGREES] += 1
        offs[i] = off
        inside = 1.0 - (off / limit) ** 2
        weight = inside * inside / (sigma * sigma)
        row[0], row[1], row[2] = py * nz - pz * ny, pz * nx - px * nz, px * ny - py * nx
        row[3], row[4], row[5] = nx, ny, nz
        tile = (line * rule.tiles // view.height) * rule.tiles + column * rule.tiles // view.width
        _add(row, weight, off, tile, sums)
        _add_noise(row, (px, py, pz), weight * tilt * tilt, sums.by_noise)


@njit(nogil=True, error_model="numpy")
def _add(row, weight, off, tile, sums):
    """Adds one point to the normal equations of its tile."""
    for j in range(6):
        sums.gradient[tile, j] += weight * row[j] * off
        for k in range(6):
            sums.normal[tile, j, k] += weight * row[j] * row[k]


@njit(nogil=True, error_model="numpy")
def _add_noise(row, point, weight, by_noise):
    """Adds what noise in a plane's slopes alone makes of one point; `row` is lost.

    The sum over three axes less that along the normal: over two axes along the surface.
    """
    px, py, pz = point
    for j in range(6):
        for k in range(6):
            by_noise[j, k] -= weight * row[j] * row[k]
    for axis in range(3):
        # unit vector e: (p x e, e)
        row[0], row[1], row[2] = 0.0, 0.0, 0.0
        row[3], row[4], row[5] = 0.0, 0.0, 0.0
        row[3 + axis] = 1.0
        if axis == 0:
            row[1], row[2] = pz, -py
        elif axis == 1:
            row[0], row[2] = -pz, px
        else:
            row[0], row[1] = py, -px
        for j in range(6):
            for k in range(6):
                by_noise[j, k] += weight * row[j] * row[k]
