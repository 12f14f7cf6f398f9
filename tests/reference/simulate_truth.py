"""Naive twins of the simulator's truth: plain clipping of triangles, rays through triangles one by one."""

import numpy as np


def touched(triangles, lower, edge, shape, shrink=1e-9):
    """Voxels whose open box meets a triangle: clip it by the six planes of each box, see what is left."""
    result = np.zeros(shape, dtype=bool)
    for index in np.ndindex(*shape):
        low = lower + np.array(index) * edge + shrink
        high = lower + (np.array(index) + 1) * edge - shrink
        result[index] = any(reaches_inside(triangle, low, high) for triangle in triangles)
    return result


def reaches_inside(triangle, low, high):
    """Whether some of a triangle is strictly inside a box: no face of the box holds all of the rest."""
    rest = [np.array(corner, dtype=float) for corner in triangle]
    for axis in range(3):
        for sign, plane in ((1.0, low[axis]), (-1.0, high[axis])):
            rest = clipped(rest, axis, sign, plane)
            if not rest:
                return False
    rest = np.array(rest)
    return bool((rest.max(axis=0) > low).all() and (rest.min(axis=0) < high).all())


def clipped(polygon, axis, sign, plane):
    """The part of a polygon on one side of an axis-aligned plane (Sutherland and Hodgman 1974)."""
    result = []
    for here, there in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        inside_here, inside_there = sign * (here[axis] - plane), sign * (there[axis] - plane)
        if inside_here >= 0:
            result.append(here)
        if inside_here * inside_there < 0:
            result.append(here + (there - here) * inside_here / (inside_here - inside_there))
    return result


def winding(triangles, point):
    """How often a closed mesh goes round a point: its solid angle (van Oosterom, Strackee 1983)."""
    a, b, c = (triangles[:, corner] - point for corner in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = (
        la * lb * lc
        + np.einsum("ij,ij->i", a, b) * lc
        + np.einsum("ij,ij->i", b, c) * la
        + np.einsum("ij,ij->i", c, a) * lb
    )
    return round(float(2 * np.arctan2(above, below).sum() / (4 * np.pi)))


def first_hit(triangles, origin, direction):
    """Length along a ray to the nearest triangle, infinite if there is none (Moeller and Trumbore 1997)."""
    a, ab, ac = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    p = np.cross(direction, ac)
    determinant = np.einsum("ij,ij->i", ab, p)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = origin - a
        u = np.einsum("ij,ij->i", s, p) / determinant
        q = np.cross(s, ab)
        v = q @ direction / determinant
        t = np.einsum("ij,ij->i", ac, q) / determinant
    hit = (np.abs(determinant) > 1e-14) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return float(t[hit].min()) if hit.any() else np.inf
