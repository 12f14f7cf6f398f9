"""Which voxels the machine's own body covers."""

from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.bits import Words
from elbowroom.machine.machine import Joints, Machine


def default_growth(grid: VoxelGrid) -> float:
    """By how much the body is grown where nothing else is said: half a voxel [m]."""
    return grid.voxel_size_m / 2


def body_words(machine: Machine, joints: Joints, grid: VoxelGrid, growth_m: float | None = None) -> Words:
    """The plane of the voxels that the grown body covers."""
    raise NotImplementedError
