"""The way of a motion: every voxel that the moving links touch, beside a naive twin. The ball turns along itself."""

import numpy as np
import pytest

from elbowroom.evaluate.thesis.way_view import STEP_IN_VOXELS, WayView
from elbowroom.geometry import bits
from elbowroom.machine import body_words
from elbowroom.motion import Motion
from elbowroom.simulate import Moment
from elbowroom.simulate.machine_solids import link_solids
from reference.motion_machines import HOME, room, slider_and_arm
from reference.motion_sweep import box_cuts_triangle

GRID = room(0.1)
LENGTHS = {"slide": 0.25, "turn": 0.8, "nod": 0.7}
JOINTS = {**HOME, "turn": 0.2, "nod": -0.3}


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    return slider_and_arm(tmp_path_factory.mktemp("machine"))


@pytest.fixture(scope="module")
def view(machine):
    return WayView(machine, Moment(0.0, link_solids(machine, JOINTS), JOINTS), GRID)


def moving_triangles(machine, motion, travel):
    """Triangles of the links that a motion moves, after some travel, shape (n, 3, 3), world frame."""
    joints = {**JOINTS, motion.joint: JOINTS[motion.joint] + motion.direction * travel}
    placed = machine.world_from_links(joints)
    return np.concatenate(
        [
            link.triangles @ placed[link.name][:3, :3].T + placed[link.name][:3, 3]
            for link in machine.links
            if link.name in machine.moved_links(motion.joint)
        ]
    )


def touched_voxels(triangles, grown=0.0):
    """Indices of the voxels, grown on each side, that triangles meet: one after another."""
    half, found = GRID.voxel_size_m / 2 + grown, set()
    for triangle in triangles:
        first = np.floor((triangle.min(axis=0) - grown - GRID.lower_m) / GRID.voxel_size_m).astype(int)
        last = np.floor((triangle.max(axis=0) + grown - GRID.lower_m) / GRID.voxel_size_m).astype(int)
        for offset in np.ndindex(*(last - first + 1)):
            index = tuple(int(n) for n in first + offset)
            if index not in found and box_cuts_triangle(triangle, GRID.centre_of(np.array(index)), half):
                found.add(index)
    return found


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("joint", LENGTHS)
def test_a_way_holds_each_voxel_that_the_moved_mesh_touches_and_none_beside_it(
    machine, view, joint, direction
):
    motion, length = Motion(joint, direction, 0.2), LENGTHS[joint]
    way = view.way(motion, length)
    indices = [tuple(index) for index in GRID.index_of(way.centres).tolist()]
    met = dict(zip(indices, way.travel.tolist(), strict=True))
    body = bits.unpack(body_words(machine, JOINTS, GRID), GRID)
    assert len(met) == len(way.centres) and not any(body[index] for index in met)
    for travel in np.linspace(0.0, length, 7).tolist():
        for index in touched_voxels(moving_triangles(machine, motion, travel)):
            assert body[index] or met[index] <= travel
    # a step moves nothing by more than this, and begins at the travel that is said
    slack = STEP_IN_VOXELS * GRID.voxel_size_m
    firsts = np.unique(way.travel)
    for travel in firsts[:: max(1, len(firsts) // 4)].tolist():
        near = touched_voxels(moving_triangles(machine, motion, travel), slack + 1e-9)
        assert {index for index, first in met.items() if first == travel} <= near


def test_a_joint_that_does_not_move_has_no_way(view):
    for length in (0.0, -0.01):
        way = view.way(Motion("turn", 1, 0.2), length)
        assert way.centres.shape == (0, 3) and way.travel.shape == (0,)
