"""Which voxels the machine's own body covers."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.parallel import spread, thread_count
from elbowroom.machine.joint_state import Joints
from elbowroom.machine.kernels.body import mark_balls, mark_points
from elbowroom.machine.machine import Machine
from elbowroom.machine.samples import ROUNDING_M, BodySamples, body_samples

POINTS_PER_THREAD = 40_000
"""Fewer samples than this for each thread are not worth another one."""


def default_growth(grid: VoxelGrid) -> float:
    """By how much the body is grown where nothing else is said: half a voxel [m]."""
    return grid.voxel_size_m / 2


def body_words(
    machine: Machine,
    joints: Joints,
    grid: VoxelGrid,
    growth_m: float | None = None,
) -> Words:
    """The plane of the voxels that the grown body covers.

    Set is every voxel that the solid body touches, and every one within `growth_m` less a quarter voxel of
    its surface. Never set is a voxel farther than `growth_m` from the body. Unchecked links are part of the
    body; what lies outside the grid is left out.

    Args:
        machine: whose body.
        joints: one position for each joint, by name [m or rad].
        grid: the watched box.
        growth_m: by how much the body is grown [m], at least a quarter voxel; None: half a voxel.

    Raises:
        MachineError: joints that are not possible, more than one configuration, or a growth below a quarter
            voxel.
    """
    samples = body_samples(machine, grid.voxel_size_m, unchecked=True)
    growth = default_growth(grid) if growth_m is None else growth_m
    if not (np.isfinite(growth) and growth >= samples.cover_m):
        raise MachineError(f"growth_m is {growth}, must be at least {samples.cover_m:g} m, a quarter voxel")
    positions = machine.positions(joints)
    if positions.ndim != 1:
        raise MachineError(f"body_words takes one position for each joint, got arrays of {len(positions)}")
    world_from_link = machine.world_from_link_array(positions[None])[0]
    total = len(samples.points) + len(samples.interior)
    shares = min(thread_count(), max(1, total // POINTS_PER_THREAD))
    planes = spread(lambda share: _mark(samples, world_from_link, grid, growth, share, shares), range(shares))
    for plane in planes[1:]:
        planes[0] |= plane
    return planes[0]


def _mark(
    samples: BodySamples,
    world_from_link: NDArray[np.float64],
    grid: VoxelGrid,
    growth_m: float,
    share: int,
    shares: int,
) -> Words:
    """One share of the samples, on a plane of its own."""
    words, lattice = bits.empty(grid), bits.lattice(grid)
    inner = len(samples.interior)
    reach = growth_m - ROUNDING_M / 2 - samples.bound_m
    mark_balls(samples.clusters, share, shares, world_from_link, reach, lattice, words)
    mark_points(
        samples.interior,
        samples.interior_link,
        inner * share // shares,
        inner * (share + 1) // shares,
        world_from_link,
        lattice,
        words,
    )
    return words
