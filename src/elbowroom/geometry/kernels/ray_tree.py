"""Rays through triangles that hang in a tree of boxes."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

LEAF = 4
"""A box of so many triangles is not halved."""
DEPTH = 64
"""The tree is no deeper: halves by number, so 2^60 triangles would fit."""


class Tree(NamedTuple):
    """Triangles in a tree of boxes, in which halves lie one after the other.

    Fields:
        corners: of the triangles, float64, shape (n, 3, 3).
        order: triangles as the leaves have them, int64, shape (n,).
        first, stop: of each box, its part of `order`, int64, shape (boxes,).
        halves: of each box, the first of its two halves, which lie side by side; -1: a leaf, int64, shape (boxes,).
        lower, upper: of each box, float64, shape (boxes, 3).
    """

    corners: np.ndarray
    order: np.ndarray
    first: np.ndarray
    stop: np.ndarray
    halves: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


@njit(cache=True, nogil=True, error_model="numpy")
def meet(tree, origins, directions, limits, distances, triangles):
    """Where each ray first meets a triangle, from either side.

    Args:
        tree: of the triangles.
        origins, directions: shape (n, 3).
        limits: shape (n,), multiples of the directions' lengths beyond which nothing counts.
        distances: shape (n,), written: multiples of the directions' lengths; the limit where nothing is met.
        triangles: shape (n,), written: which is met; -1: none.
    """
    waiting = np.empty(DEPTH, np.int64)
    for n in range(origins.shape[0]):
        distances[n], triangles[n] = limits[n], -1
        count = 0
        if tree.order.size and _reach(tree, 0, origins[n], directions[n], distances[n]) < math.inf:
            waiting[0], count = 0, 1
        while count > 0:
            count -= 1
            box = waiting[count]
            half = tree.halves[box]
            if half < 0:
                for k in range(tree.first[box], tree.stop[box]):
                    found = _distance(tree.corners[tree.order[k]], origins[n], directions[n])
                    if found < distances[n]:
                        distances[n], triangles[n] = found, tree.order[k]
                continue
            near = _reach(tree, half, origins[n], directions[n], distances[n])
            far = _reach(tree, half + 1, origins[n], directions[n], distances[n])
            # the nearer half is looked at first: what it finds may rule the other out
            swapped = far < near
            if max(near, far) < math.inf:
                waiting[count] = half if swapped else half + 1
                count += 1
            if min(near, far) < math.inf:
                waiting[count] = half + 1 if swapped else half
                count += 1


@njit(nogil=True, error_model="numpy")
def _reach(tree, box, origin, direction, limit):
    """Where a ray enters a box; infinity: nowhere before the limit."""
    near, far = 0.0, float(limit)
    for axis in range(3):
        if direction[axis] == 0.0:
            if not (tree.lower[box, axis] <= origin[axis] <= tree.upper[box, axis]):
                return math.inf
            continue
        a = (tree.lower[box, axis] - origin[axis]) / direction[axis]
        b = (tree.upper[box, axis] - origin[axis]) / direction[axis]
        near, far = max(near, min(a, b)), min(far, max(a, b))
    # what rounding takes away must not lose a triangle that lies in a box's side
    return near if near <= far * (1.0 + 1e-12) + 1e-300 else math.inf


@njit(nogil=True, error_model="numpy")
def _distance(corners, origin, direction):
    """Where a ray meets a triangle, as a multiple of its direction; infinity: it does not.

    Möller and Trumbore, Fast, minimum storage ray-triangle intersection, 1997. Edges belong to the triangle.
    """
    ax, ay, az = corners[0, 0], corners[0, 1], corners[0, 2]
    ex, ey, ez = corners[1, 0] - ax, corners[1, 1] - ay, corners[1, 2] - az
    fx, fy, fz = corners[2, 0] - ax, corners[2, 1] - ay, corners[2, 2] - az
    dx, dy, dz = float(direction[0]), float(direction[1]), float(direction[2])
    px, py, pz = dy * fz - dz * fy, dz * fx - dx * fz, dx * fy - dy * fx
    volume = ex * px + ey * py + ez * pz
    if volume == 0.0:
        return math.inf
    tx, ty, tz = origin[0] - ax, origin[1] - ay, origin[2] - az
    u = (tx * px + ty * py + tz * pz) / volume
    qx, qy, qz = ty * ez - tz * ey, tz * ex - tx * ez, tx * ey - ty * ex
    v = (dx * qx + dy * qy + dz * qz) / volume
    distance = (fx * qx + fy * qy + fz * qz) / volume
    # neighbours share an edge to the last bit of their corners, and not of these sums: no gap between them
    slack = 1e-9
    return distance if u >= -slack and v >= -slack and u + v <= 1.0 + slack and distance >= 0.0 else math.inf
