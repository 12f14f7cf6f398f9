"""A pixel's widened cone and a voxel: whether it misses the voxel, has left it, or has not reached it.

A pixel's cone holds the directions (x, y, 1) with u within 0.5 + lateral of its centre. Along grid axis a such a
direction moves by d_a(u, v), linear in u and v. With the voxel's faces at low_a and high_a from the camera's centre,
the cone has left the voxel at depth t once t * d_a is beyond the far face for some axis, has not reached it while
t * d_a is before the near face for some axis, and misses it if it passes a silhouette edge on the outer side.
"""

from typing import NamedTuple

import numpy as np

from elbowroom.geometry.kernels.bits import uncounted

VOXEL = np.dtype((np.record, [("low", "f8", 3), ("high", "f8", 3), ("lines", "i8"), ("line", "f8", (6, 4))]))
"""Scratch memory for one voxel and camera: its faces, as seen from the camera's centre [m], and silhouette lines.

A pixel is beyond a line, outside the voxel, where line[0] + line[1] u + line[2] v + line[3] < 0; the last is the line's
half width over a widened pixel.
"""


class Pixel(NamedTuple):
    """One pixel: its column and row, up to where it is free [quanta], and the texel of what it measured."""

    u: int
    v: int
    free_to: np.uint32
    measured: np.uint32


@uncounted(cache=True, error_model="numpy")
def _silhouette(b, c, rays, voxel):
    """Adds the two lines that bound the voxel as seen along the third axis; none if the camera is within its shadow.

    In the plane of axes b and c the voxel is a rectangle; the directions that meet it lie between two of its corners.
    """
    low_b, high_b, low_c, high_c = voxel.low[b], voxel.high[b], voxel.low[c], voxel.high[c]
    if low_b <= 0.0 <= high_b and low_c <= 0.0 <= high_c:
        return
    # the extreme corners, counter-clockwise from `first` to `second` as seen from the origin
    if low_b > 0.0:
        first_b, first_c = (high_b, low_c) if low_c > 0.0 else (low_b, low_c)
        second_b, second_c = (high_b, high_c) if high_c < 0.0 else (low_b, high_c)
    elif high_b < 0.0:
        first_b, first_c = (low_b, high_c) if high_c < 0.0 else (high_b, high_c)
        second_b, second_c = (low_b, low_c) if low_c > 0.0 else (high_b, low_c)
    elif low_c > 0.0:
        first_b, first_c, second_b, second_c = high_b, low_c, low_b, low_c
    else:
        first_b, first_c, second_b, second_c = low_b, high_c, high_b, high_c
    for corner in range(2):
        # inside where cross(first, d) >= 0 and cross(d, second) >= 0
        pb = first_b if corner == 0 else -second_b
        pc = first_c if corner == 0 else -second_c
        for n in range(3):
            voxel.line[voxel.lines, n] = pb * rays[n, c] - pc * rays[n, b]
        voxel.lines += 1


@uncounted(cache=True, error_model="numpy")
def prepare(camera, box, voxel):
    """Fills the scratch record for one voxel and camera."""
    half = 0.5 * box.edge
    wide = 0.5 + camera.lateral_px
    for a in range(3):
        middle = (box.x if a == 0 else (box.y if a == 1 else box.z)) - camera.centre_in_world[a]
        voxel.low[a] = middle - half
        voxel.high[a] = middle + half
    voxel.lines = 0
    # not literals: numba would compile it once for each of them
    first, second, third = np.int64(0), np.int64(1), np.int64(2)
    _silhouette(first, second, camera.ray, voxel)
    _silhouette(second, third, camera.ray, voxel)
    _silhouette(third, first, camera.ray, voxel)
    for n in range(voxel.lines):
        voxel.line[n, 3] = (abs(voxel.line[n, 1]) + abs(voxel.line[n, 2])) * wide


@uncounted(cache=True, forceinline=True)
def misses(voxel, u, v):
    """Whether a pixel's cone passes the voxel."""
    for n in range(voxel.lines):
        line = voxel.line[n]
        if line[0] + line[1] * u + line[2] * v + line[3] < 0.0:
            return True
    return False


@uncounted(cache=True, forceinline=True)
def has_left(camera, voxel, pixel, t):
    """Whether all of the pixel's cone is beyond the voxel from depth t on."""
    for a in range(3):
        d = camera.ray[0, a] + camera.ray[1, a] * pixel.u + camera.ray[2, a] * pixel.v
        low, high = d - camera.ray_half_width[a], d + camera.ray_half_width[a]
        if low >= 0.0 and t * low > voxel.high[a]:
            return True
        if high <= 0.0 and t * high < voxel.low[a]:
            return True
    return False


@uncounted(cache=True, forceinline=True)
def not_reached(camera, voxel, pixel, t):
    """Whether no part of the pixel's cone has reached the voxel up to depth t."""
    for a in range(3):
        d = camera.ray[0, a] + camera.ray[1, a] * pixel.u + camera.ray[2, a] * pixel.v
        if max(t * (d + camera.ray_half_width[a]), 0.0) < voxel.low[a]:
            return True
        if min(t * (d - camera.ray_half_width[a]), 0.0) > voxel.high[a]:
            return True
    return False


@uncounted(cache=True, error_model="numpy", forceinline=True)
def steepness(camera, u, v):
    """Of the directions in a pixel's cone, the least and the greatest ratio of the camera's depth to planar depth."""
    steep_near, steep_far = 1.0, 1.0
    if camera.radial:
        wide = 0.5 + camera.lateral_px
        xn, yn = abs(u - camera.cx) / camera.fx, abs(v - camera.cy) / camera.fy
        wx, wy = wide / camera.fx, wide / camera.fy
        steep_far = np.sqrt(1.0 + (xn + wx) * (xn + wx) + (yn + wy) * (yn + wy))
        xl, yl = max(xn - wx, 0.0), max(yn - wy, 0.0)
        steep_near = np.sqrt(1.0 + xl * xl + yl * yl)
    return steep_near, steep_far
