"""Free travel against exact mesh distance, and machines that others built."""

import math
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.motion import Cause, JointPath, Level, Motion, check_motion, check_motions, joint_motions
from elbowroom.reconstruct.free_space import FreeSpace
from reference.motion_machines import nothing_in, touched_by_ball, touched_by_box

SPEEDS = {"long": 0.15, "larm": math.radians(12), "propeller": math.radians(25), "carc": math.radians(25)}
CASES = 24


def intervention_room(voxel_size_m):
    return VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), voxel_size_m)


@pytest.fixture(scope="module")
def c_arm():
    return ceiling_c_arm()


def test_free_travel_is_never_more_than_exact_mesh_distance_allows_and_little_less(c_arm):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    from reference import motion_exact as exact

    grid = intervention_room(0.05)
    trees = exact.meshes_of(c_arm)
    rng = np.random.default_rng(11)
    shortfalls = []
    while len(shortfalls) < CASES:
        joints = {joint.name: rng.uniform(0.8 * joint.lower, 0.8 * joint.upper) for joint in c_arm.joints}
        name = rng.choice(c_arm.joint_names)
        motion = Motion(name, int(rng.choice([-1, 1])), 0.1 if name == "long" else 0.15)
        # where some point of the machine will be, so that most solids are met
        ahead = {name: np.clip(joints[name] + motion.direction * 0.3, -0.6, 0.6)}
        link = c_arm.links[c_arm.link_names.index(rng.choice(["l_arm", "c_arc", "detector", "source"]))]
        place = c_arm.world_from_links(joints | ahead)[link.name]
        middle = place[:3, :3] @ rng.choice(link.vertices) + place[:3, 3]
        middle += rng.uniform(-0.1, 0.1, 3)
        centre, radius = rng.uniform((-1.4, -1.4, 0.2), (1.4, 1.4, 2.0)), rng.uniform(0.05, 0.2)
        size = rng.uniform(0.05, 0.4, 3)
        solids = [exact.box(middle, size), exact.ball(centre, radius)]
        if exact.gap(trees, c_arm.world_from_links(joints), trees, solids)[0] < 2 * grid.voxel_size_m:
            continue
        joint = c_arm.joint(name)
        room = joint.upper - joints[name] if motion.direction > 0 else joints[name] - joint.lower
        truth, speed = exact.travel_until_contact(
            c_arm, trees, joints, motion, min(motion.looked_at, room), solids
        )
        if speed is None:
            continue
        occupied = touched_by_box(grid, middle - size / 2, middle + size / 2)
        occupied |= touched_by_ball(grid, centre, radius)
        space = FreeSpace.from_occupied(grid, occupied).without(c_arm, joints)
        verdict = check_motion(space, c_arm, joints, motion)
        assert verdict.free_travel <= truth
        shortfalls.append((truth - verdict.free_travel) * speed / grid.voxel_size_m)
    assert np.median(shortfalls) <= 1.5


@pytest.mark.parametrize("voxel_size_m", (0.05, 0.1))
@pytest.mark.parametrize("larm", (-1.5, -0.4, 0.0, 0.8, 1.5))
def test_the_c_arm_alone_is_clear_in_all_directions(c_arm, voxel_size_m, larm):
    grid = intervention_room(voxel_size_m)
    joints = {"long": 0.1, "larm": larm, "propeller": 0.5 * larm, "carc": -0.4 * larm}
    space = FreeSpace.from_occupied(grid, nothing_in(grid)).without(c_arm, joints)
    for verdict in check_motions(space, c_arm, joints, joint_motions(c_arm, SPEEDS, 0.5)):
        assert (verdict.level, verdict.cause) == (Level.CLEAR, Cause.NONE)


def test_the_first_step_of_a_body_does_not_block_itself(c_arm):
    # everything but the body is blocked: the first interval is free, and the halo ends the travel soon after
    grid = intervention_room(0.05)
    joints = dict.fromkeys(c_arm.joint_names, 0.0)
    space = FreeSpace.from_occupied(grid, ~nothing_in(grid)).without(c_arm, joints)
    for verdict in check_motions(space, c_arm, joints, joint_motions(c_arm, SPEEDS, 0.5)):
        assert verdict.level is Level.STOP
        assert 0 < verdict.free_travel < 0.05


@pytest.fixture(scope="module")
def ur5():
    try:
        robots = metadata.distribution("example-robot-data")
    except metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed; no UR5")
    share = Path(robots.locate_file("cmeel.prefix/share"))
    return Machine.from_urdf(share / "example-robot-data/robots/ur_description/urdf/ur5_robot.urdf")


def test_a_six_axis_arm_is_stopped_by_a_wall_and_free_to_leave_it(ur5):
    grid = VoxelGrid.covering((-1.2, -1.2, -0.6), (1.2, 1.2, 1.3), 0.05)
    names = ur5.joint_names
    joints = dict.fromkeys(names, 0.0) | {names[1]: -0.3, names[2]: 0.4}
    open_space = FreeSpace.from_occupied(grid, nothing_in(grid)).without(ur5, joints)
    motions = joint_motions(ur5, dict.fromkeys(names, 0.5), 0.3)
    assert {verdict.level for verdict in check_motions(open_space, ur5, joints, motions)} == {Level.CLEAR}
    reach = max(placed[:2, 3].tolist() for placed in ur5.world_from_links(joints).values())
    wall = touched_by_box(grid, (-1.2, reach[1] + 0.3, -0.6), (1.2, 1.2, 1.3))
    walled = FreeSpace.from_occupied(grid, wall).without(ur5, joints)
    turn = names[0]
    levels = {
        direction: check_motion(walled, ur5, joints, Motion(turn, direction, 0.4)).level
        for direction in (1, -1)
    }
    assert levels[1] is not Level.CLEAR
    assert levels[-1] is Level.CLEAR
    path = JointPath([{turn: 1.2, names[3]: 0.5}], 0.4)
    verdict = check_motion(walled, ur5, joints, path)
    assert (verdict.cause, verdict.free_travel_unit) == (Cause.SURFACE, "rad")
    assert 0 < verdict.free_travel < 1.2
