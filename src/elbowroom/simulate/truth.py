"""Ground truth: every voxel that a solid touches, with the machine's own voxels apart."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.parallel import spread
from elbowroom.simulate.kernels import touch as kernels
from elbowroom.simulate.solid import Moment, Solid

SHRINK_M = 1e-9
"""A voxel's open box is taken smaller by this on each side: a face meant to lie on a boundary of voxels
touches neither, whatever rounding does [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """Which voxels solids touch at one moment.

    Args:
        occupied: bool, shape of the grid, index order x, y, z: touched by a solid that is not the machine.
        machine: the same for the machine's own links. A voxel may be in both.
    """

    occupied: NDArray[np.bool_]
    machine: NDArray[np.bool_]


def true_occupancy(grid: VoxelGrid, moment: Moment) -> Truth:
    """Every voxel whose open box a solid meets: surface by a triangle-box test, inside by winding number.

    A floor whose top is z = 0 touches no voxel above it. Solids that never move are computed once a grid.

    Args:
        grid: the watched box; solids may reach beyond it.
        moment: the solids.
    """
    occupied = _static_occupancy(grid, moment.static_solids).copy()
    machine = np.zeros(grid.shape, dtype=np.bool_)
    moving = moment.moving_solids
    for solid, (corner, touched) in zip(moving, _touch_all(grid, moving), strict=True):
        _add(machine if solid.is_machine else occupied, corner, touched)
    return Truth(occupied, machine)


@lru_cache(maxsize=8)
def _static_occupancy(grid: VoxelGrid, solids: tuple[Solid, ...]) -> NDArray[np.bool_]:
    occupied = np.zeros(grid.shape, dtype=np.bool_)
    for corner, touched in _touch_all(grid, solids):
        _add(occupied, corner, touched)
    occupied.setflags(write=False)
    return occupied


def true_centres(grid: VoxelGrid, moment: Moment) -> NDArray[np.bool_]:
    """Every voxel whose centre lies in a solid that is not the machine: the milder measure beside `true_occupancy`.

    Args:
        grid: the watched box.
        moment: the solids.

    Returns:
        bool, shape of the grid, index order x, y, z.
    """
    solids = tuple(solid for solid in moment.solids if not solid.is_machine)
    inside = np.zeros(grid.shape, dtype=np.bool_)
    for corner, part in spread(lambda solid: touched_by(grid, solid, surface=False), solids):
        _add(inside, corner, part)
    return inside


Touched = tuple[NDArray[np.int64], NDArray[np.bool_]]
"""Index of the first voxel of a part of the grid, and that part."""


def _touch_all(grid: VoxelGrid, solids: tuple[Solid, ...]) -> list[Touched]:
    return spread(lambda solid: touched_by(grid, solid), solids)


def touched_by(grid: VoxelGrid, solid: Solid, *, surface: bool = True) -> Touched:
    """The part of the grid about one solid: its first index, shape (3,), and which of its voxels are touched.

    The part is empty where the solid lies outside the grid.

    Args:
        grid: the voxels.
        solid: closed.
        surface: also voxels that its surface meets; False: only those whose centre is inside.
    """
    vertices = solid.vertices_in_world
    edge, origin, shape = grid.voxel_size_m, grid.lower_m, np.array(grid.shape)
    first = np.clip(np.floor((vertices.min(axis=0) - origin) / edge) - 1, 0, shape).astype(np.int64)
    last = np.clip(np.floor((vertices.max(axis=0) - origin) / edge) + 2, 0, shape).astype(np.int64)
    touched = np.zeros(np.maximum(last - first, 0), dtype=np.bool_)
    if touched.size:
        triangles = vertices[solid.mesh.faces]
        lower = origin + first * edge
        if surface:
            kernels.touch_surface(triangles, lower, edge, SHRINK_M, touched)
        kernels.fill_inside(triangles, lower, edge, touched)
    return first, touched


def _add(volume: NDArray[np.bool_], corner: NDArray[np.int64], touched: NDArray[np.bool_]) -> None:
    part = tuple(slice(c, c + n) for c, n in zip(corner, touched.shape, strict=True))
    volume[part] |= touched
