"""The surface of a machine's checked links in pieces that hang together, as coarse as it is swept."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine, body_samples
from elbowroom.machine.shape import Shape
from elbowroom.motion.kernels.covered import Pieces


def pieces(machine: Machine, voxel_size_m: float) -> Pieces:
    """The surface of a machine's checked links in pieces.

    Args:
        machine: whose links.
        voxel_size_m: edge of a voxel [m].
    """
    return _pieces_of(machine.shape, checked_rows(machine), body_samples(machine, voxel_size_m).bound_m)


def checked_rows(machine: Machine) -> tuple[int, ...]:
    """The rows of a machine's checked links that have a body."""
    names = machine.checked_links
    return tuple(row for row, link in enumerate(machine.links) if link.name in names and link.has_geometry)


@kept
def _pieces_of(shape: Shape, rows: tuple[int, ...], bound_m: float) -> Pieces:
    links = shape.within(bound_m)
    found = [(row, piece) for row in rows for piece in cut(links[row].triangles)]
    triangles = np.concatenate([np.zeros((0, 3, 3)), *(piece for _, piece in found)])
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    centre = (low + high) / 2
    return Pieces(
        triangles,
        centre,
        np.linalg.norm(triangles - centre[:, None], axis=2).max(axis=1, initial=0.0),
        np.cumsum([0, *(len(piece) for _, piece in found)]),
        np.array([row for row, _ in found], dtype=np.int64),
        np.array([_is_closed(piece) for _, piece in found], dtype=np.bool_),
        np.array([piece.min(axis=(0, 1)) for _, piece in found]).reshape(-1, 3),
        np.array([piece.max(axis=(0, 1)) for _, piece in found]).reshape(-1, 3),
    )


def cut(triangles: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Triangles that hang together by their corners, piece by piece.

    Args:
        triangles: of a link, shape (m, 3, 3) [m].
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    corners, number = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = number.reshape(-1, 3)
    edges = np.concatenate([faces[:, :2], faces[:, 1:]])
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(len(corners),) * 2)
    _, label = connected_components(graph, directed=False)
    of = label[faces[:, 0]]
    return [triangles[of == one] for one in np.unique(of)]


def _is_closed(triangles: NDArray[np.float64]) -> bool:
    """Whether an even number of triangles meets at each edge: so a ray out of it tells within from without."""
    _, number = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = number.reshape(-1, 3)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    return bool((counts % 2 == 0).all())
