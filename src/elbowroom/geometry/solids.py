"""Closed triangle meshes of simple solids, corners that are one, and whether a mesh is closed.

What trimesh makes of boxes and cylinders and says of surfaces, number by number, without loading it: with what it
imports that takes longer than all else that a start with such solids needs.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Triangles = tuple[NDArray[np.float64], NDArray[np.int64]]
"""Vertices, shape (n, 3) [m], and faces, shape (m, 3)."""

SAME_M = 1e-8
"""Vertices that lie so close together are one [m]."""
FAR_M = 1e10
"""Farther out they are not told apart: 64 bits do not count such steps; whoever has them is refused [m]."""
_CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=np.float64)
_SIDES = np.array(
    [
        *((1, 3, 0), (4, 1, 0), (0, 3, 2), (2, 4, 0), (1, 7, 3), (5, 1, 4)),
        *((5, 7, 1), (3, 7, 2), (6, 4, 2), (2, 7, 6), (6, 5, 4), (7, 5, 6)),
    ],
    dtype=np.int64,
)


def box(size_m: ArrayLike) -> Triangles:
    """A box about the origin.

    Args:
        size_m: its edges along the axes, shape (3,) [m].
    """
    return (_CORNERS - 0.5) * np.asarray(size_m, dtype=np.float64), _SIDES.copy()


def prism(radius_m: float, length_m: float, sides: int) -> Triangles:
    """A prism along z about the origin, its corners on a circle; the middles of its ends are vertices, too.

    Args:
        radius_m, length_m: of the circle, and along z [m].
        sides: flat sides around, 3 or more.
    """
    angle = np.linspace(0, 2 * np.pi, sides + 1)[:-1]
    half = abs(float(length_m)) / 2
    rings = np.empty((sides, 2, 3))  # its corners below and above
    rings[:, :, 0], rings[:, :, 1] = (of(angle)[:, None] * radius_m for of in (np.cos, np.sin))
    rings[:, :, 2] = (-half, half)
    ends = np.array([(0.0, 0.0, -half), (0.0, 0.0, half)])
    vertices = np.concatenate([ends[:1], rings[0], ends[1:], rings[1:].reshape(-1, 3)])
    low = np.append(1, np.arange(4, 2 * sides + 2, 2))
    high = np.append(2, low[1:] + 1)
    below, above = np.zeros_like(low), np.full_like(low, 3)
    low_next, high_next = np.roll(low, -1), np.roll(high, -1)
    corners = (
        (low, below, low_next),
        (low, low_next, high),
        (high, low_next, high_next),
        (high, high_next, above),
    )
    return vertices, np.array(corners, dtype=np.int64).transpose(2, 0, 1).reshape(-1, 3)


def turn_of_z(direction: ArrayLike) -> NDArray[np.float64]:
    """A rotation that brings the z axis to a direction, shape (3, 3).

    Args:
        direction: shape (3,), not zero.
    """
    z, to = (np.linalg.svd(np.reshape(one, (3, 1)))[0] for one in ((0.0, 0.0, 1.0), direction))
    for frame in (z, to):
        if np.linalg.det(frame) < 0:
            frame[:, -1] *= -1.0
    turn: NDArray[np.float64] = to.dot(z.T)
    return turn


def merged(places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Places that are one, in the order in which each first comes.

    Args:
        places: shape (n, 3) [m].

    Returns:
        Those, shape (m, 3); and which of them each place is, shape (n,).
    """
    rounded = np.round(np.clip(places, -FAR_M, FAR_M) / SAME_M).astype(np.int64)
    sorted_by = np.lexsort(rounded.T)
    is_new = np.append(True, (np.diff(rounded[sorted_by], axis=0) != 0).any(axis=1))[: len(places)]
    first = sorted_by[is_new]
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    number = np.empty_like(sorted_by)
    number[sorted_by] = rank[np.cumsum(is_new) - 1]
    return places[first[order]], number


def is_closed(vertices: NDArray[np.float64], faces: NDArray[np.integer]) -> bool:
    """Whether a surface is made of closed shells whose faces turn outward.

    Args:
        vertices: shape (n, 3) [m]; those at one place are one.
        faces: shape (m, 3).
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    if not len(faces):
        return False
    places, number = merged(vertices)
    corner = number[faces]
    ahead = np.stack([corner, np.roll(corner, -1, axis=1)], axis=-1).reshape(-1, 2)
    of_edge = np.sort(ahead, axis=1) @ (len(places), 1)
    order = np.argsort(of_edge, kind="stable")
    pairs = order.reshape(-1, 2) if len(order) % 2 == 0 else order[:0].reshape(0, 2)
    edges = of_edge[pairs]
    is_watertight = len(pairs) and (edges[:, 0] == edges[:, 1]).all() and (np.diff(edges[:, 0]) > 0).all()
    if not is_watertight or (ahead[pairs[:, 0]] == ahead[pairs[:, 1]]).any():
        return False
    one, other = pairs.T // 3
    count = len(faces)
    shells, shell = connected_components(
        coo_array((np.ones(len(one)), (one, other)), shape=(count, count)), directed=False
    )
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    volume = np.bincount(shell, np.einsum("ni,ni->n", a, np.cross(b, c)), minlength=shells)
    return bool((volume > 0).all())
