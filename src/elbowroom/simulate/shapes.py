"""Closed meshes of simple shapes, joined to larger ones."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.geometry import solids
from elbowroom.simulate.solid import Mesh

Shape = tuple[NDArray[np.float64], NDArray[np.int64]]
"""Vertices (n, 3) [m] and faces (m, 3) of one closed convex part."""


def box(lower_m: ArrayLike, upper_m: ArrayLike) -> Shape:
    """An axis-aligned box between two corners [m]."""
    lower, upper = np.asarray(lower_m, dtype=float), np.asarray(upper_m, dtype=float)
    vertices, faces = solids.box((1, 1, 1))
    return np.where(vertices > 0, upper, lower), faces


def ellipsoid(centre_m: ArrayLike, radii_m: ArrayLike, rows: int = 6, columns: int = 10) -> Shape:
    """An ellipsoid along the axes.

    Args:
        centre_m, radii_m: shape (3,) [m].
        rows, columns: patches of its surface from pole to pole, and around.
    """
    return _sphere_like(rows, columns, np.asarray(centre_m, dtype=float), np.asarray(radii_m, dtype=float))


def capsule(
    start_m: ArrayLike, end_m: ArrayLike, radius_m: float, *, squeeze: float = 1.0, columns: int = 8
) -> Shape:
    """A capsule between two points.

    Args:
        start_m, end_m: middles of its two half balls, shape (3,) [m].
        radius_m: of both [m].
        squeeze: factor by which its cross-section is narrower along x.
        columns: patches around.
    """
    start, end = np.asarray(start_m, dtype=float), np.asarray(end_m, dtype=float)
    length = float(np.linalg.norm(end - start))
    vertices, faces = _sphere_like(6, columns, np.zeros(3), np.full(3, radius_m))
    vertices[vertices[:, 2] > 1e-9, 2] += length  # the equator stays: six rows put a ring of vertices on it
    turned = vertices @ solids.turn_of_z(end - start).T
    turned[:, 0] *= squeeze
    return turned + start, faces


def cylinder(start_m: ArrayLike, end_m: ArrayLike, radius_m: float, sections: int = 16) -> Shape:
    """A round bar between two points.

    Args:
        start_m, end_m: middles of its ends, shape (3,) [m].
        radius_m: of the bar [m].
        sections: flat faces around.
    """
    start, end = np.asarray(start_m, dtype=float), np.asarray(end_m, dtype=float)
    vertices, faces = solids.prism(radius_m, float(np.linalg.norm(end - start)), sections)
    placed = np.column_stack([solids.turn_of_z(end - start), start + 0.5 * (end - start)])
    return np.dot(placed, np.column_stack([vertices, np.ones(len(vertices))]).T).T, faces


def join(parts: Sequence[Shape]) -> Mesh:
    """One mesh of several closed parts, which may overlap."""
    offsets = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    return Mesh(
        np.concatenate([vertices for vertices, _ in parts]),
        np.concatenate([faces + offset for (_, faces), offset in zip(parts, offsets, strict=False)]).astype(
            np.int32
        ),
    )


def _sphere_like(rows: int, columns: int, centre: NDArray[np.float64], radii: NDArray[np.float64]) -> Shape:
    """Poles and rings of vertices, triangles between them."""
    heights = np.linspace(np.pi, 0.0, rows + 1)[1:-1]
    turns = np.arange(columns) * 2 * np.pi / columns
    rings = np.stack(
        [
            np.outer(np.sin(heights), np.cos(turns)),
            np.outer(np.sin(heights), np.sin(turns)),
            np.outer(np.cos(heights), np.ones(columns)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    south, north = len(rings), len(rings) + 1
    faces = []
    for c in range(columns):
        following = (c + 1) % columns
        faces.append((south, following, c))
        faces.append((north, (rows - 2) * columns + c, (rows - 2) * columns + following))
        for r in range(rows - 2):
            a, b = r * columns + c, r * columns + following
            faces += [(a, b, b + columns), (a, b + columns, a + columns)]
    return np.concatenate([rings, [(0, 0, -1.0), (0, 0, 1.0)]]) * radii + centre, np.array(faces)
