"""The voxels that each link sweeps on some motions, beyond those that the machine covers where it stands."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import Machine, body_samples
from elbowroom.machine.body import body_words
from elbowroom.motion import Motion
from elbowroom.motion.course import Way, way_of

MOST_VOXELS = 200_000
"""Swept space is told of voxels so large that the watched box has no more."""
STEP_IN_VOXELS = 0.5
"""Between two looks along a motion no point moves much farther than this."""


def coarse_grid(grid: VoxelGrid) -> VoxelGrid:
    """The watched box in voxels as fine as its own, but no more of them than `MOST_VOXELS`."""
    size = grid.upper_m - grid.lower_m
    edge = max(grid.voxel_size_m, float(np.prod(size) / MOST_VOXELS) ** (1 / 3))
    return VoxelGrid.covering(grid.lower_m, grid.upper_m, edge)


def swept_by_link(
    grid: VoxelGrid, machine: Machine, joints: Mapping[str, float], motions: Sequence[Motion]
) -> dict[str, NDArray[np.bool_]]:
    """Of each checked link that moves, the voxels that its surface comes through.

    Args:
        grid: the watched box; what lies outside is left out.
        machine: what moves.
        joints: where it stands, by name [m or rad].
        motions: each as far as it is looked at, or to the joint's limit.

    Returns:
        By link, bool, shape of the grid; voxels of the grown body where it stands are in none.

    Raises:
        MachineError: joints that are not possible.
    """
    start, samples = machine.positions(joints), body_samples(machine, grid.voxel_size_m)
    body = bits.unpack(body_words(machine, joints, grid), grid)
    swept: dict[str, NDArray[np.bool_]] = {}
    for motion in motions:
        way = way_of(machine, start, motion)
        moved = set(machine.moved_links(motion.joint))
        for row, name in enumerate(machine.link_names):
            points = samples.points[samples.point_link == row].astype(np.float64)
            if name in moved and len(points) and way.length > 0:
                mark = swept.setdefault(name, np.zeros(grid.shape, dtype=np.bool_))
                _mark(grid, machine, way, row, points, mark)
    return {name: mark & ~body for name, mark in swept.items()}


def _mark(
    grid: VoxelGrid,
    machine: Machine,
    way: Way,
    row: int,
    points_in_link: NDArray[np.float64],
    mark: NDArray[np.bool_],
) -> None:
    """Marks the voxels of one link's points along a way."""
    ends = machine.world_from_link_array(way.course.positions[[0, -1]])[:, row]
    paths = [points_in_link @ end[:3, :3].T + end[:3, 3] for end in ends]
    farthest = float(np.linalg.norm(paths[1] - paths[0], axis=1).max())
    steps = max(1, int(np.ceil(farthest / (STEP_IN_VOXELS * grid.voxel_size_m))))
    travels = np.linspace(0.0, way.length, steps + 1)[1:]
    positions = np.column_stack(
        [np.interp(travels, way.course.travel, column) for column in way.course.positions.T]
    )
    for pose in machine.world_from_link_array(positions)[:, row]:
        places = points_in_link @ pose[:3, :3].T + pose[:3, 3]
        index = np.floor((places - grid.lower_m) / grid.voxel_size_m)
        inside = ((index >= 0) & (index < grid.shape)).all(axis=1)
        mark[tuple(index[inside].astype(np.int64).T)] = True
