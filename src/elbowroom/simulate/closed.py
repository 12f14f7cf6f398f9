"""Whether triangles close: corners at one place made one, edges counted, volume summed."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.simulate.solid import Mesh


def merged_mesh(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> Mesh:
    """Vertices at one place made one; triangles that thereby lose a corner left out, and those that are there twice.

    A triangle with a twin that is turned the other way, as double-sided materials are exported, is left out if the
    rest closes without.

    Args:
        vertices: shape (n, 3).
        faces: shape (m, 3), indices of vertices.
    """
    places, index = np.unique(vertices, axis=0, return_inverse=True)
    joined = index.reshape(-1)[faces]
    whole = (joined != np.roll(joined, 1, axis=1)).all(axis=1)
    mesh = Mesh(places, joined[whole])
    if not len(mesh.faces):
        return mesh
    for turned_too in (False, True):
        first = _first_of_alike(mesh.faces, turned_too=turned_too)
        once = Mesh(places, mesh.faces[first]) if len(first) < len(mesh.faces) else mesh
        if _has_inside(once):
            return once
    return mesh


def _has_inside(mesh: Mesh) -> bool:
    return open_edge_count(mesh) == 0 and signed_volume(mesh) != 0


def _first_of_alike(faces: NDArray[np.int32], *, turned_too: bool) -> NDArray[np.int64]:
    """Which triangles are the first with their corners, in the order of the file."""
    if turned_too:
        key = np.sort(faces, axis=1)
    else:
        first = np.argmin(faces, axis=1)
        key = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return np.sort(np.unique(key, axis=0, return_index=True)[1])


def open_edge_count(mesh: Mesh) -> int:
    """Edges that are not passed as often in one direction as in the other: 0 for closed, consistently turned faces."""
    a, b = mesh.faces.astype(np.int64), np.roll(mesh.faces, -1, axis=1).astype(np.int64)
    key = (np.minimum(a, b) * len(mesh.vertices) + np.maximum(a, b)).reshape(-1)
    _, index = np.unique(key, return_inverse=True)
    return int(np.count_nonzero(np.bincount(index.reshape(-1), weights=np.sign(b - a).reshape(-1))))


def signed_volume(mesh: Mesh) -> float:
    """Of a closed mesh [m^3]; below 0 where its faces point inwards; 0 where it is flat or each has its turned twin."""
    if not len(mesh.faces):
        return 0.0
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces] - mesh.vertices.mean(axis=0), 1, 0)
    parts = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    volume = float(parts.sum())
    return volume if abs(volume) > 1e-9 * float(np.abs(parts).sum()) else 0.0
