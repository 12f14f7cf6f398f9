"""Small machines and rooms for the tests of motions."""

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine

SLIDER_AND_ARM = """<robot name="slider_and_arm">
<link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<link name="cart"><collision><geometry><box size="0.3 0.2 0.2"/></geometry></collision></link>
<link name="arm"><collision><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.1 0.12"/></geometry>
</collision></link>
<link name="hand"><collision><geometry><sphere radius="0.09"/></geometry></collision></link>
<joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/><origin xyz="0 0 0.3"/>
  <axis xyz="1 0 0"/><limit lower="-0.5" upper="0.5" effort="0" velocity="1"/></joint>
<joint name="turn" type="revolute"><parent link="cart"/><child link="arm"/><origin xyz="0 0 0.2"/>
  <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="0" velocity="1"/></joint>
<joint name="nod" type="revolute"><parent link="arm"/><child link="hand"/><origin xyz="0.6 0 0.1"/>
  <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="0" velocity="1"/></joint>
</robot>"""
HOME = {"slide": 0.0, "turn": 0.0, "nod": 0.0}


def slider_and_arm(folder, **more):
    """Cart on a rail in x, on it an arm of 0.6 m along x that turns about z, and a round hand at the end."""
    path = folder / "slider_and_arm.urdf"
    path.write_text(SLIDER_AND_ARM)
    return Machine.from_urdf(path, **more)


def room(voxel_size_m, lower=(-1.5, -1.5, -0.3), upper=(1.5, 1.5, 1.2)):
    """A grid that holds the arm wherever it goes."""
    return VoxelGrid.covering(lower, upper, voxel_size_m)


def nothing_in(grid):
    """A volume without a blocked voxel."""
    return np.zeros(grid.shape, dtype=bool)


def touched_by_box(grid, lower, upper):
    """The voxels whose open box meets a box."""
    corner = grid.lower_m + np.moveaxis(np.indices(grid.shape), 0, -1) * grid.voxel_size_m
    return ((corner < np.asarray(upper)) & (corner + grid.voxel_size_m > np.asarray(lower))).all(axis=-1)


def touched_by_ball(grid, centre, radius):
    """The voxels whose open box meets a ball."""
    corner = grid.lower_m + np.moveaxis(np.indices(grid.shape), 0, -1) * grid.voxel_size_m
    nearest = np.clip(centre, corner, corner + grid.voxel_size_m)
    return np.linalg.norm(nearest - np.asarray(centre), axis=-1) < radius
