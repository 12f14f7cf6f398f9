"""Rays turned into a solid's frame, and what a sensor makes of exact depth."""

import numpy as np
from numba import njit

EDGE_STEP_M = 0.05
"""A step in depth of this makes an edge [m]."""


@njit(cache=True, nogil=True)
def turn_rays(directions, solid_from_camera, rows, columns, depth, turned, known):
    """Directions of a rectangle of pixels in the frame of a solid.

    Args:
        directions: shape (h, w, 3), camera frame.
        solid_from_camera: rotation, shape (3, 3).
        rows, columns: first and one past the last.
        depth: planar depth known so far, shape (h, w) [m].
        turned: float32, shape (at least rows x columns, 3), written.
        known: float32, shape (at least rows x columns,), written: the depth of these pixels.
    """
    r = solid_from_camera
    n = 0
    for v in range(rows[0], rows[1]):
        for u in range(columns[0], columns[1]):
            x, y, z = directions[v, u, 0], directions[v, u, 1], directions[v, u, 2]
            turned[n, 0] = r[0, 0] * x + r[0, 1] * y + r[0, 2] * z
            turned[n, 1] = r[1, 0] * x + r[1, 1] * y + r[1, 2] * z
            turned[n, 2] = r[2, 0] * x + r[2, 1] * y + r[2, 2] * z
            known[n] = depth[v, u]
            n += 1


@njit(cache=True, nogil=True)
def keep_nearer(hits, is_dark, rows, columns, depth, dark):
    """Puts hits that are nearer than what is known into a rectangle of the image.

    Args:
        hits: planar depth, shape (at least rows x columns,) [m].
        is_dark: whether the solid that was hit is dark.
        rows, columns: first and one past the last.
        depth: shape (h, w), written.
        dark: bool, shape (h, w), written.
    """
    n = 0
    for v in range(rows[0], rows[1]):
        for u in range(columns[0], columns[1]):
            if hits[n] < depth[v, u]:
                depth[v, u] = hits[n]
                dark[v, u] = is_dark
            n += 1


@njit(cache=True, nogil=True)
def disturb(depth, dark, lengths, normal, uniform, noise, sensor, radial, out):
    """Depth as a sensor delivers it: flying pixels, noise, missing returns, its range.

    A pixel is at an edge where inverse depth bends: for planes it is linear over the image, so that a floor
    seen at a grazing angle is no edge.

    Args:
        depth: planar depth, infinite where nothing is, shape (h, w) [m].
        dark: where a dark surface is seen, shape (h, w).
        lengths: radial over planar depth, shape (h, w).
        normal: standard normal numbers, shape (h, w).
        uniform: random uint32, shape (h, w).
        noise: sigma's constant, linear and quadratic coefficient and offset.
        sensor: flying share, missing share, dark missing share, grazing missing share, least and greatest
            depth [m], relative change of depth from pixel to pixel from which a smooth surface is grazed.
        radial: whether the camera delivers radial depth, which is also what its noise depends on.
        out: shape (h, w), written; 0 is no return.
    """
    height, width = depth.shape
    flying, missing, dark_missing, grazing_missing, least, greatest, grazed = sensor
    for v in range(height):
        for u in range(width):
            z = depth[v, u]
            chance = float(uniform[v, u] & np.uint32(0xFFFF)) / 65536.0
            mix = float(uniform[v, u] >> np.uint32(16)) / 65536.0
            lost = missing
            if dark[v, u]:
                lost += dark_missing
            near, far, slope = _neighbourhood(depth, v, u)
            if slope > grazed:
                lost += grazing_missing
            if chance >= 1.0 - lost or not z < np.inf:
                out[v, u] = 0.0
                continue
            if far > near and far < np.inf and chance < flying:
                z = near + mix * (far - near)
            if radial:
                z *= lengths[v, u]
            beyond = max(z - noise[3], 0.0)
            z += normal[v, u] * (noise[0] + noise[1] * z + noise[2] * beyond * beyond)
            out[v, u] = z if z > 0.0 and least <= z <= greatest else 0.0


@njit(cache=True, nogil=True)
def _neighbourhood(depth, v, u):
    """Least and greatest depth across an edge (equal where there is none), relative slope where smooth."""
    height, width = depth.shape
    z = depth[v, u]
    near, far, slope = z, z, 0.0
    if not z < np.inf:
        return near, far, slope
    for axis in range(2):
        if axis == 0:
            if u == 0 or u == width - 1:
                continue
            a, b = depth[v, u - 1], depth[v, u + 1]
        else:
            if v == 0 or v == height - 1:
                continue
            a, b = depth[v - 1, u], depth[v + 1, u]
        bend = abs(1.0 / a - 2.0 / z + 1.0 / b)
        if bend * z * z > EDGE_STEP_M:
            near, far = min(near, a, b), max(far, a, b)
        else:
            slope = max(slope, abs(b - a) / (2.0 * z))
    return near, far, slope


@njit(cache=True, nogil=True)
def as_delivered(depth, lengths, least, greatest, radial, out):
    """Exact planar depth as a perfect sensor of this kind and range delivers it; 0 is no return."""
    for v in range(depth.shape[0]):
        for u in range(depth.shape[1]):
            z = depth[v, u]
            if radial:
                z *= lengths[v, u]
            out[v, u] = z if z < np.inf and least <= z <= greatest else 0.0
