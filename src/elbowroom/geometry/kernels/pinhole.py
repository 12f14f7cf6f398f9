"""A pinhole camera: from a point to its pixel, and from a pixel to its ray.

`lens` is any record with fx, fy, cx and cy [px].
"""

import math

from numba import njit


@njit(inline="always")
def pixel_of(lens, x, y, z):
    """Column and row of a point in the camera's axes, not rounded; z must not be 0."""
    return lens.fx * x / z + lens.cx, lens.fy * y / z + lens.cy


@njit(inline="always")
def ray_of(lens, u, v):
    """The direction of column u and row v in the camera's axes, as (X/Z, Y/Z)."""
    return (u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy


@njit(inline="always")
def radial_over_planar(x, y):
    """By how much the way along a ray (x, y, 1) is longer than its planar depth."""
    return math.sqrt(1.0 + x * x + y * y)
