"""Links as meshes that are light to draw, and as points that stand for them."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.machine.samples import surface_points

MOST_TRIANGLES = 8_000
"""A link of more is drawn with its corners brought together."""
POINTS_EVERY_M = 0.05
"""Points of links lie about so close [m]."""


def light_mesh(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], most: int = MOST_TRIANGLES
) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """A mesh of at most so many triangles, for the eye: corners of one cell of a lattice become one.

    Args:
        vertices: shape (n, 3) [m].
        faces: shape (m, 3).
        most: triangles.

    Returns:
        Corners and triangles.
    """
    size = 0.002
    light, kept = vertices, np.asarray(faces, dtype=np.int64)
    while len(kept) > most:
        cells = np.floor(vertices / size).astype(np.int64)
        _, first, of = np.unique(cells, axis=0, return_index=True, return_inverse=True)
        light, kept = vertices[first], of.reshape(-1)[faces]
        differ = (kept[:, 0] != kept[:, 1]) & (kept[:, 1] != kept[:, 2]) & (kept[:, 0] != kept[:, 2])
        kept = np.unique(np.sort(kept[differ], axis=1), axis=0) if size > 0.05 else kept[differ]
        size *= 1.5
    return light.astype(np.float32), kept.astype(np.uint32)


def link_points(machine: Machine, every_m: float = POINTS_EVERY_M) -> dict[str, NDArray[np.float64]]:
    """By link with a body, points on its surface, shape (n, 3), link frame [m].

    Args:
        machine: whose links.
        every_m: about how far apart [m].
    """
    found = {}
    for link in machine.links:
        if link.has_geometry:
            points = surface_points(link.triangles, every_m)
            cells = np.floor(points / every_m).astype(np.int64)
            found[link.name] = points[np.unique(cells, axis=0, return_index=True)[1]]
    return found


def points_in_world(
    machine: Machine, points: Mapping[str, NDArray[np.float64]], joints: Mapping[str, float]
) -> NDArray[np.float64]:
    """Points of all links where the machine stands, shape (n, 3), world frame [m].

    Args:
        machine: whose links.
        points: of `link_points`.
        joints: its positions by name [m or rad].
    """
    poses = machine.world_from_links(joints)
    placed = [p @ poses[name][:3, :3].T + poses[name][:3, 3] for name, p in points.items()]
    return np.concatenate([np.zeros((0, 3)), *placed])


def wxyz_of(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """A rotation as a quaternion, w first.

    Args:
        rotation: shape (3, 3).
    """
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(rotation).as_quat()
    return float(w), float(x), float(y), float(z)
