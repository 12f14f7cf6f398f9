"""Grids, cameras and transforms: where things are, before anything was measured."""

from elbowroom.geometry.camera import DepthCamera
from elbowroom.geometry.grid import VoxelGrid
from elbowroom.geometry.intrinsics import Intrinsics
from elbowroom.geometry.transforms import invert_rigid, looking_at, nearest_rigid

__all__ = ["DepthCamera", "Intrinsics", "VoxelGrid", "invert_rigid", "looking_at", "nearest_rigid"]
