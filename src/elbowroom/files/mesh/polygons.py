"""Polygons cut into triangles: those that bulge from one corner, others ear by ear."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def triangles_of(vertices: Array, polygons: Sequence[Sequence[int]]) -> Indices:
    """Triangles that cover polygons as they are, dented ones, too, and keep their turn.

    Args:
        vertices: shape (n, 3).
        polygons: indices of vertices; those of fewer than three are no surface.

    Returns:
        shape (m, 3).
    """
    by_size: dict[int, list[Sequence[int]]] = {}
    for polygon in polygons:
        by_size.setdefault(len(polygon), []).append(polygon)
    found = [np.zeros((0, 3), dtype=np.int64)]
    for size, alike in by_size.items():
        if size >= 3:
            found.append(_of_one_size(vertices, np.array(alike, dtype=np.int64)))
    return np.concatenate(found)


def fan(corners: Indices) -> Indices:
    """Triangles about the first corner of each polygon, shape (polygons, corners) to (m, 3)."""
    count = corners.shape[1] - 2
    parts = [corners[:, [0, k + 1, k + 2]] for k in range(count)]
    return np.stack(parts, axis=1).reshape(-1, 3)


def strip(corners: Indices) -> Indices:
    """Triangles of a strip, every second one turned, shape (n,) to (n - 2, 3)."""
    triangles = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
    triangles[1::2] = triangles[1::2, [1, 0, 2]]
    return triangles


def _of_one_size(vertices: Array, corners: Indices) -> Indices:
    if corners.shape[1] == 3:
        return corners
    places = vertices[corners]
    normals = _normals(places)
    turns = _turns(places, normals)
    dented = (turns < -1e-9 * np.abs(turns).max(axis=1, keepdims=True, initial=0.0)).any(axis=1)
    cut = [_ears(places[n], normals[n], corners[n]) for n in np.flatnonzero(dented)]
    return np.concatenate([fan(corners[~dented]), *cut])


def _normals(places: Array) -> Array:
    """Of each polygon by all of its corners (Newell), shape (polygons, corners, 3) to (polygons, 3), of any length."""
    about = places - places[:, :1]
    return np.asarray(np.cross(about, np.roll(about, -1, axis=1)).sum(axis=1))


def _turns(places: Array, normals: Array) -> Array:
    """How far each corner turns in its polygon's sense, below 0 at a dent, shape (polygons, corners)."""
    before, after = places - np.roll(places, 1, axis=1), np.roll(places, -1, axis=1) - places
    return np.asarray(np.einsum("ijk,ik->ij", np.cross(before, after), normals))


def _ears(places: Array, normal: Array, corners: Indices) -> Indices:
    """One dented polygon (Meisters: Polygons have ears, 1975)."""
    drop = int(np.argmax(np.abs(normal)))
    flat = np.delete(places, drop, axis=1)
    sense = np.sign(normal[drop]) * (-1.0 if drop == 1 else 1.0)
    left, found = list(range(len(corners))), []
    while len(left) > 3:
        ear = next((n for n in range(len(left)) if _is_ear(flat, sense, left, n)), None)
        if ear is None:  # it crosses itself: as good as any other way
            break
        found.append((left[ear - 1], left[ear], left[(ear + 1) % len(left)]))
        del left[ear]
    found += [(left[0], left[k], left[k + 1]) for k in range(1, len(left) - 1)]
    return corners[np.array(found)]


def _is_ear(flat: Array, sense: float, left: list[int], n: int) -> bool:
    a, b, c = (flat[left[k % len(left)]] for k in (n - 1, n, n + 1))
    if sense * _area(a, b, c) <= 0:
        return False
    for k in left:
        p = flat[k]
        if any((p == corner).all() for corner in (a, b, c)):
            continue
        if min(sense * _area(a, b, p), sense * _area(b, c, p), sense * _area(c, a, p)) >= 0:
            return False
    return True


def _area(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
