"""How high the floor of a modelled room is."""

from collections.abc import Sequence

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.simulate.solid import Solid
from elbowroom.simulate.taken import Taken

EDGE_M = 0.1
BELOW_M, ABOVE_M = 0.5, 1.5
"""A floor is looked for so far below and above the watched box's bottom [m]."""


def floor_height(box: VoxelGrid, solids: Sequence[Solid]) -> float:
    """Height of the floor, world frame [m]: where most columns of the box begin to be empty; else the box's bottom.

    Args:
        box: the watched box.
        solids: closed ones of the room.
    """
    lower, upper = box.lower_m, box.upper_m
    bottom = lower[2]
    grid = VoxelGrid.covering((*lower[:2], bottom - BELOW_M), (*upper[:2], bottom + ABOVE_M), EDGE_M)
    inside = Taken.of(grid, solids).inside
    filled = inside.any(axis=2)
    if filled.mean() < 0.2:
        return float(bottom)
    # of each column, where the lowest solid in it ends
    first = inside.argmax(axis=2)
    above = np.arange(grid.shape[2]) >= first[..., None]
    ends = np.where((~inside & above).any(axis=2), (~inside & above).argmax(axis=2), -1)[filled]
    level = grid.lower_m[2] + np.bincount(ends[ends >= 0], minlength=1).argmax() * EDGE_M
    tops = [solid.vertices_in_world[:, 2] for solid in solids]
    near = np.concatenate([top[np.abs(top - level) <= EDGE_M] for top in tops])
    return float(near.max()) if len(near) else float(level)
