"""The machine is drawn where its links are."""

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid
from elbowroom.machine import ceiling_c_arm
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.view import section
from elbowroom.view.draw.outline import triangles_of
from elbowroom.view.draw.plot import TOP_PX

GRID = VoxelGrid(origin_m=(-2.0, -2.0, 0.0), shape=(40, 40, 25), voxel_size_m=0.1)
ALL_FREE = FreeSpace.from_occupied(GRID, np.zeros(GRID.shape, dtype=bool))
JOINTS = {"long": 0.1, "larm": 0.3, "propeller": -0.2, "carc": 0.1}


def test_triangles_lie_where_forward_kinematics_puts_the_links():
    machine = ceiling_c_arm()
    triangles = triangles_of(machine, JOINTS)
    assert len(triangles) == sum(len(link.faces) for link in machine.links)
    moved = triangles_of(machine, {**JOINTS, "long": 0.2})
    shift = np.unique((moved - triangles).round(9).reshape(-1, 3), axis=0)
    np.testing.assert_allclose(sorted(shift.tolist()), [[0, 0, 0], [0.1, 0, 0]], atol=1e-9)


@pytest.mark.parametrize(("axis", "plane"), [("z", [0, 1]), ("y", [0, 2]), ("x", [1, 2])])
def test_the_picture_changes_within_the_machines_bounds_and_up_to_them(axis, plane):
    machine = ceiling_c_arm()
    at_m = 1.1 if axis == "z" else 0.0
    bare = np.array(section(ALL_FREE, axis, at_m)).astype(int)
    drawn = np.array(section(ALL_FREE, axis, at_m, machine=machine, joints=JOINTS)).astype(int)
    px_per_m, left = 250, (bare.shape[1] - 1000) // 2
    height = round((GRID.upper_m - GRID.lower_m)[plane[1]] * px_per_m)
    area = slice(TOP_PX, TOP_PX + height), slice(max(84, left), max(84, left) + 1000)
    rows, columns = np.nonzero((bare[area] != drawn[area]).any(axis=-1))
    found = [columns.min(), columns.max() + 1, rows.min(), rows.max() + 1]
    triangles = triangles_of(machine, JOINTS)[:, :, plane]
    shown = triangles[(triangles.min(axis=1) < GRID.upper_m[plane]).all(axis=1)].reshape(-1, 2)
    lower = np.maximum(shown.min(axis=0), GRID.lower_m[plane])
    upper = np.minimum(shown.max(axis=0), GRID.upper_m[plane])
    right = (np.array([lower[0], upper[0]]) - GRID.lower_m[plane[0]]) * px_per_m
    down = (GRID.upper_m[plane[1]] - np.array([upper[1], lower[1]])) * px_per_m
    np.testing.assert_allclose(found, [*right, *down], atol=4)
