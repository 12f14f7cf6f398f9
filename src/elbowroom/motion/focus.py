"""Where the motions can go: the part of the grid that a cycle has to look at."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import Machine, body_samples
from elbowroom.motion.course import Way, way_of
from elbowroom.motion.motion import JointPath, Motion

BLOCK = 4
"""Voxels along the edge of a block: one word of a plane."""
STOPS = 5
"""At so many places along each motion the body is looked at."""
SAMPLES_VOXEL_M = 0.2
"""Clusters of the samples for voxels of this size stand for the body."""


def blocks_in_reach(
    grid: VoxelGrid,
    machine: Machine,
    joints: Mapping[str, float],
    motions: Sequence[Motion | JointPath],
) -> NDArray[np.bool_]:
    """The blocks of 4 voxels that the body comes near on its motions, for `reconstruct(focus=...)`.

    What is left out stays unseen, and so blocked: it can cost freedom, never safety.

    Args:
        grid: the watched box.
        machine: what moves.
        joints: where it is now, by name [m or rad].
        motions: what is going to be checked.

    Returns:
        bool, shape (words,), in the order of the planes.

    Raises:
        MachineError: an unknown joint, or a position that is missing or out of its limits.
    """
    start = machine.positions(joints)
    ways = [way_of(machine, start, motion) for motion in motions]
    shares = np.linspace(0.0, 1.0, STOPS)[1:]
    places = np.stack([start, *(_place(way, share * way.length) for way in ways for share in shares)])
    samples = body_samples(machine, SAMPLES_VOXEL_M)
    world_from_link = machine.world_from_link_array(places)[:, samples.cluster_link]
    centres = np.einsum("pcij,cj->pci", world_from_link[..., :3, :3], samples.cluster_centre)
    centres += world_from_link[..., :3, 3]
    # between two stops the body stays within half of what it moves from one to the next
    apart = np.linalg.norm(centres[1:] - centres[:1], axis=-1).max(initial=0.0) / (STOPS - 1)
    around = samples.cluster_radius[None, :, None] + apart / 2 + 2 * grid.voxel_size_m
    cells = bits.lattice(grid)
    counts = 4 * np.array([cells.cubes_x, cells.cubes_y, cells.cubes_z])
    edge = BLOCK * grid.voxel_size_m
    first = (
        np.floor((centres - around - grid.lower_m) / edge).astype(np.int64).reshape(-1, 3).clip(0, counts - 1)
    )
    last = (
        np.floor((centres + around - grid.lower_m) / edge).astype(np.int64).reshape(-1, 3).clip(0, counts - 1)
    )
    near = np.zeros(tuple(counts), dtype=np.bool_)
    for low, high in np.unique(np.hstack([first, last]), axis=0).reshape(-1, 2, 3).tolist():
        near[low[0] : high[0] + 1, low[1] : high[1] + 1, low[2] : high[2] + 1] = True
    by_cube = near.reshape(cells.cubes_x, 4, cells.cubes_y, 4, cells.cubes_z, 4)
    return by_cube.transpose(0, 2, 4, 1, 3, 5).reshape(-1)


def _place(way: Way, travel: float) -> NDArray[np.float64]:
    """Joint positions after some travel, between the knots of the way's course."""
    knots, columns = way.course.travel, way.course.positions.T
    return np.array([np.interp(travel, knots, column) for column in columns])
