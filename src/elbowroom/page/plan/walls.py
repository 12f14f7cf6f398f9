"""A room without what would hide its inside: ceiling and walls are left out, floor and furniture stay."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.simulate.solid import Solid

BAND_M = 0.35
"""So far from the end of a room its walls may reach inwards [m]."""
SHARE = 0.4
"""What spans so much of a side, both ways, may be that side's wall."""


def open_room(solids: Sequence[Solid], walls_m: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """Triangles of a room, shape (n, 3, 3), world frame [m].

    Args:
        solids: of the room.
        walls_m: least and greatest corner of the room, shape (2, 3) [m]; None: all of it stays.
    """
    kept = [np.zeros((0, 3, 3))]
    for solid in solids:
        part = solid.vertices_in_world[solid.mesh.faces]
        kept.append(part if walls_m is None or not len(part) else part[~_is_wall(part, walls_m)])
    return np.concatenate(kept)


def _is_wall(triangles: NDArray[np.float64], walls_m: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Triangles of one thing that belong to a wall or the ceiling, shape (n,)."""
    spans = np.ptp(triangles.reshape(-1, 3), axis=0) >= SHARE * (walls_m[1] - walls_m[0])
    wall = np.zeros(len(triangles), dtype=bool)
    for axis in range(3):
        if not np.delete(spans, axis).all():
            continue
        wall |= (triangles[:, :, axis] >= walls_m[1, axis] - BAND_M).all(axis=1)
        if axis < 2:
            wall |= (triangles[:, :, axis] <= walls_m[0, axis] + BAND_M).all(axis=1)
    return wall
