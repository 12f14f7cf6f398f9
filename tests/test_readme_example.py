"""The library's example, word for word as a user meets it; then what its answers must be."""

import numpy as np
import pytest

import elbowroom as er
from elbowroom.machine.c_arm import CEILING_C_ARM_URDF, UNCHECKED_LINKS


def test_the_library_as_a_user_meets_it():
    path = CEILING_C_ARM_URDF
    depth = np.full((480, 640), 3.0)
    occupied = np.zeros((200, 200, 125), dtype=bool)
    seen_through, surface = np.zeros((2, 200, 200, 125), dtype=bool)

    grid = er.VoxelGrid(origin_m=(-2, -2, 0), shape=(200, 200, 125), voxel_size_m=0.02)
    camera = er.DepthCamera(
        name="north",
        width=640,
        height=480,
        world_from_camera=np.eye(4),
        intrinsics=er.Intrinsics(fx=320, fy=320, cx=319.5, cy=239.5),
        depth_kind="planar",
        noise=er.NoiseModel(constant_m=0.0015, linear=0.0, quadratic=0.00025),
    )
    frame = er.DepthFrame(camera="north", stamp_ns=0, depth_m=depth)
    machine = er.Machine.from_urdf(path)
    joints = {"long": 0.0, "larm": 0.2, "propeller": 0.0, "carc": 0.0}
    space = er.reconstruct(
        grid,
        cameras=[camera],
        frames=[frame],
        machine=machine,
        joints=joints,
        rule="three",
        detail="pixel",
        margin=er.Margin(sigmas=3.0, bias_m=0.0, lateral_px=0.5),
        now_ns=None,
        max_age_ns=None,
    )
    space.free, space.surface, space.unseen
    verdict = er.check_motion(
        space, machine, joints, er.Motion(joint="larm", direction=+1, braking_distance=0.05)
    )
    verdict.level, verdict.band, verdict.free_travel, verdict.cause
    truth = er.FreeSpace.from_occupied(grid, occupied).without(machine, joints)
    lidar = er.Evidence.from_mask(grid, "lidar-1", seen_through, surface)

    for volume in (space.free, space.surface, space.unseen):
        assert volume.shape == (200, 200, 125)
        assert volume.dtype == np.bool_
    assert (space.free.astype(int) + space.surface + space.unseen == 1).all()
    # the camera at the origin looks up along z; its image is 90 degrees wide
    assert space.free[100, 100, 100]
    assert space.unseen[199, 100, 1]
    assert isinstance(verdict.level, er.Level)
    assert isinstance(verdict.cause, er.Cause)
    assert verdict.band in "SML0"
    assert 0.0 <= verdict.free_travel <= 5 * 0.05
    assert truth.free.all()
    assert lidar.cameras == ("lidar-1",)


def test_the_truth_of_an_empty_room_lets_every_joint_go():
    machine = er.Machine.from_urdf(CEILING_C_ARM_URDF, unchecked_links=UNCHECKED_LINKS)
    joints = {"long": 0.0, "larm": 0.2, "propeller": 0.0, "carc": 0.0}
    grid = er.VoxelGrid(origin_m=(-2, -2, 0), shape=(40, 40, 25), voxel_size_m=0.1)
    truth = er.FreeSpace.from_occupied(grid, np.zeros(grid.shape, dtype=bool)).without(machine, joints)
    verdict = er.check_motion(
        truth, machine, joints, er.Motion(joint="larm", direction=+1, braking_distance=0.05)
    )
    assert (verdict.level, verdict.band, verdict.cause) == (er.Level.CLEAR, "0", er.Cause.NONE)
    assert verdict.free_travel == pytest.approx(0.25)
