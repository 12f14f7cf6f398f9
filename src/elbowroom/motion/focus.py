"""Where the motions can go: the part of the grid that a cycle has to look at."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import Machine, body_samples
from elbowroom.motion.course import Way, way_of
from elbowroom.motion.kernels.focus import mark_ways
from elbowroom.motion.motion import JointPath, Motion

BLOCK = 4
"""Voxels along the edge of a block: one word of a plane."""
STOPS = 5
"""At so many places along each motion the body is looked at."""
SAMPLES_VOXEL_M = 0.1
"""Clusters of the samples for voxels of this size stand for the body."""
SPARE_VOXELS = 2.0
"""By so much the clusters are grown: by what a body is grown, and for ways that are not quite straight."""


def blocks_in_reach(
    grid: VoxelGrid,
    machine: Machine,
    joints: Mapping[str, float],
    motions: Sequence[Motion | JointPath],
    around_m: float = 0.0,
) -> NDArray[np.bool_]:
    """The blocks of 4 voxels that the body comes near on its motions, for `reconstruct(focus=...)`.

    What is left out stays unseen, and so blocked: it can cost freedom, never safety.

    Args:
        grid: the watched box.
        machine: what moves.
        joints: where it is now, by name [m or rad].
        motions: what is going to be checked.
        around_m: about the body where it is now, all that is so near is looked at as well [m].

    Returns:
        bool, shape (words,), in the order of the planes.

    Raises:
        MachineError: an unknown joint, or a position that is missing or out of its limits.
    """
    start = machine.positions(joints)
    shares = np.linspace(0.0, 1.0, STOPS)[1:]
    stops = [_places(way, shares * way.length) for way in (way_of(machine, start, m) for m in motions)]
    # each stop is reached from the one before it, the first of each motion from the start
    before = np.arange(-1, len(stops) * len(shares))
    before[0], before[1 :: len(shares)] = 0, 0
    samples = body_samples(machine, SAMPLES_VOXEL_M)
    balls = samples.clusters._replace(radius=samples.cluster_radius + SPARE_VOXELS * grid.voxel_size_m)
    lattice = bits.lattice(grid)
    edge = BLOCK * grid.voxel_size_m
    near = np.zeros((4 * lattice.cubes_x, 4 * lattice.cubes_y, 4 * lattice.cubes_z), dtype=np.bool_)
    mark_ways(
        machine.world_from_link_array(np.vstack([start[None], *stops])),
        balls,
        before,
        grid.lower_m,
        edge,
        near,
    )
    if around_m > 0:
        wide = balls._replace(radius=balls.radius + around_m)
        mark_ways(machine.world_from_link_array(start[None]), wide, before[:1], grid.lower_m, edge, near)
    by_cube = near.reshape(lattice.cubes_x, 4, lattice.cubes_y, 4, lattice.cubes_z, 4)
    return by_cube.transpose(0, 2, 4, 1, 3, 5).reshape(-1)


def _places(way: Way, travels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Joint positions after some travels, between the knots of the way's course, shape (travels, joints)."""
    knots, columns = way.course.travel, way.course.positions.T
    return np.column_stack([np.interp(travels, knots, column) for column in columns])
