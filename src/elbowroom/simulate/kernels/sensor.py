"""Rays turned into a solid's frame, and what a sensor makes of exact depth."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.noise import sigma
from elbowroom.geometry.kernels.pinhole import radial_over_planar
from elbowroom.geometry.kernels.rigid import moved, turned_back

EDGE_STEP_M = 0.05
"""A step in depth of this makes an edge [m]."""
NEAREST_M = 1e-4
"""What is nearer to the camera's plane than this counts as behind it [m]."""
FARTHEST_M = 1e4
"""Stands for the depth of nothing at all where edges are looked for [m]."""


@njit(cache=True, nogil=True)
def gather_rays(boxes, world_from_solid, camera_from_world, rays, depth):
    """The rays that may meet a solid, turned into its frame.

    Args:
        boxes: least and greatest corners of boxes that hold the solid, shape (k, 2, 3), its frame [m].
        world_from_solid, camera_from_world: shape (4, 4), rigid.
        rays: X/Z and Y/Z of the pixels and their ranges, as PixelRays.
        depth: planar depth known so far, shape (h, w) [m].

    Returns:
        The camera's centre, float32, shape (3,), and of n pixels: flat indices, shape (n,), directions,
        float32, shape (n, 3), both in the solid's frame, and the depth known so far, float32, shape (n,).
    """
    height, width = depth.shape
    m = _camera_from_solid(world_from_solid, camera_from_world)
    may_meet = np.zeros((height, width), np.bool_)
    rows_used, columns_used = (height, 0), (width, 0)
    for box in range(boxes.shape[0]):
        top, bottom, left, right = _rectangle(boxes[box], m, rays.x_range, rays.y_range)
        if top < bottom and left < right:
            may_meet[top:bottom, left:right] = True
            rows_used = (min(rows_used[0], top), max(rows_used[1], bottom))
            columns_used = (min(columns_used[0], left), max(columns_used[1], right))
    count = 0
    for v in range(rows_used[0], rows_used[1]):
        for u in range(columns_used[0], columns_used[1]):
            count += may_meet[v, u]
    pixels = np.empty(count, np.int64)
    turned = np.empty((count, 3), np.float32)
    known = np.empty(count, np.float32)
    n = 0
    for v in range(rows_used[0], rows_used[1]):
        for u in range(columns_used[0], columns_used[1]):
            if may_meet[v, u]:
                turned[n, 0], turned[n, 1], turned[n, 2] = turned_back(
                    m, float(rays.x[v, u]), float(rays.y[v, u]), 1.0
                )
                known[n] = depth[v, u]
                pixels[n] = v * width + u
                n += 1
    x, y, z = turned_back(m, m[0, 3], m[1, 3], m[2, 3])
    origin = np.array((-x, -y, -z), np.float32)
    return origin, pixels, turned, known


@njit(cache=True, nogil=True)
def _camera_from_solid(world_from_solid, camera_from_world):
    """The product of the two, three rows of it."""
    m = np.empty((3, 4))
    for row in range(3):
        for column in range(4):
            m[row, column] = camera_from_world[row, 3] if column == 3 else 0.0
            for k in range(3):
                m[row, column] += camera_from_world[row, k] * world_from_solid[k, column]
    return m


@njit(cache=True, nogil=True)
def _rectangle(bounds, camera_from_solid, x_range, y_range):
    """First and one past the last row and column that a box may meet; all if it reaches behind the camera."""
    low_x, high_x, low_y, high_y = np.inf, -np.inf, np.inf, -np.inf
    behind = 0
    for corner in range(8):
        x, y, z = moved(
            camera_from_solid, bounds[corner & 1, 0], bounds[(corner >> 1) & 1, 1], bounds[corner >> 2, 2]
        )
        if z < NEAREST_M:
            behind += 1
            continue
        right, down = x / z, y / z
        low_x, high_x = min(low_x, right), max(high_x, right)
        low_y, high_y = min(low_y, down), max(high_y, down)
    if behind == 8:
        return 0, 0, 0, 0
    if behind > 0:
        return 0, y_range.shape[1], 0, x_range.shape[1]
    top, bottom = _meeting(y_range, low_y - 1e-6, high_y + 1e-6)
    left, end = _meeting(x_range, low_x - 1e-6, high_x + 1e-6)
    return top, bottom, left, end


@njit(cache=True, nogil=True)
def _meeting(ranges, low, high):
    """First and one past the last interval of a list that meets (low, high)."""
    first, end = 0, 0
    for n in range(ranges.shape[1]):
        if ranges[0, n] <= high and ranges[1, n] >= low:
            if end == 0:
                first = n
            end = n + 1
    return first, end


@njit(cache=True, nogil=True)
def keep_nearer(hits, pixels, is_dark, depth, dark):
    """Puts hits that are nearer than what is known into the image.

    Args:
        hits: planar depth, shape (n,) [m].
        pixels: their flat indices, shape (n,).
        is_dark: whether the solid that was hit is dark.
        depth: shape (h, w), written.
        dark: bool, shape (h, w), written.
    """
    width = depth.shape[1]
    for n in range(hits.shape[0]):
        v, u = pixels[n] // width, pixels[n] % width
        if hits[n] < depth[v, u]:
            depth[v, u] = hits[n]
            dark[v, u] = is_dark


class Sensor(NamedTuple):
    """How a sensor departs from exact depth.

    Fields:
        flying: share of edge pixels that get a depth between both sides.
        missing, dark_missing, grazing_missing: shares without return: anywhere, and added on
            dark and grazed surfaces.
        grazed: relative change of depth from pixel to pixel from which a smooth surface is grazed.
        least, greatest: the sensor's range [m].
        constant, linear, quadratic, offset: sigma of depth, as in NoiseModel.
        radial: whether it delivers radial depth; noise and range are in that kind of depth, too.
    """

    flying: float
    missing: float
    dark_missing: float
    grazing_missing: float
    grazed: float
    least: float
    greatest: float
    constant: float
    linear: float
    quadratic: float
    offset: float
    radial: bool


@njit(cache=True, nogil=True)
def disturb(depth, dark, rays, normal, uniform, sensor, out):
    """Depth as a sensor delivers it: flying pixels, noise, missing returns, its range.

    A pixel is at an edge where inverse depth bends: for planes it is linear over the image, so that a floor
    seen at a grazing angle is no edge.

    Args:
        depth: planar depth, infinite where nothing is, shape (h, w) [m].
        dark: where a dark surface is seen, shape (h, w).
        rays: X/Z and Y/Z of the pixels, as PixelRays.
        normal: standard normal numbers, shape (h, w).
        uniform: random uint32, shape (h, w): the low half decides, the high half mixes.
        sensor: how it departs from exact depth.
        out: shape (h, w), written; 0 is no return.
    """
    height, width = depth.shape
    for v in range(height):
        for u in range(width):
            z = depth[v, u]
            out[v, u] = 0.0
            if not z < FARTHEST_M:
                continue
            near, far, change = _neighbourhood(depth, v, u)
            lost = sensor.missing
            if dark[v, u]:
                lost += sensor.dark_missing
            if change > 2.0 * sensor.grazed * z:
                lost += sensor.grazing_missing
            chance = (uniform[v, u] & np.uint32(0xFFFF)) / 65536.0
            if chance >= 1.0 - lost:
                continue
            if far > near and far < FARTHEST_M and chance < sensor.flying:
                z = near + (uniform[v, u] >> np.uint32(16)) / 65536.0 * (far - near)
            if sensor.radial:
                z *= _length(rays, v, u)
            z += normal[v, u] * sigma(sensor, z)
            if z > 0.0 and sensor.least <= z <= sensor.greatest:
                out[v, u] = z


@njit(cache=True, nogil=True)
def _neighbourhood(depth, v, u):
    """Least and greatest depth across an edge (equal if there is none), change over two pixels if smooth."""
    height, width = depth.shape
    z = min(depth[v, u], FARTHEST_M)
    near, far, change = z, z, 0.0
    for axis in range(2):
        if axis == 0:
            if u == 0 or u == width - 1:
                continue
            a, b = depth[v, u - 1], depth[v, u + 1]
        else:
            if v == 0 or v == height - 1:
                continue
            a, b = depth[v - 1, u], depth[v + 1, u]
        a, b = min(a, FARTHEST_M), min(b, FARTHEST_M)
        # |1/a - 2/z + 1/b| z^2 > step, without a division
        if abs(z * (a + b) - 2.0 * a * b) * z > EDGE_STEP_M * a * b:
            near, far = min(near, a, b), max(far, a, b)
        else:
            change = max(change, abs(b - a))
    return near, far, change


@njit(cache=True, nogil=True)
def _length(rays, v, u):
    """Radial over planar depth of a pixel."""
    return radial_over_planar(float(rays.x[v, u]), float(rays.y[v, u]))


@njit(cache=True, nogil=True)
def as_delivered(depth, rays, limits, radial, out):
    """Exact planar depth as a perfect sensor of this kind and range delivers it; 0 is no return."""
    for v in range(depth.shape[0]):
        for u in range(depth.shape[1]):
            z = depth[v, u]
            if radial:
                z *= _length(rays, v, u)
            out[v, u] = z if z < np.inf and limits[0] <= z <= limits[1] else 0.0
