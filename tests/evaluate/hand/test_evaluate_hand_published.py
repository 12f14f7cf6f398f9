"""Published arms in their hulls, and a hand that may lie between the two."""

from importlib import metadata

import numpy as np
import pytest

from elbowroom.evaluate.hand.published import PUBLISHED, PublishedArm, robots_folder, turning
from elbowroom.motion import Motion

RADIUS_M = 0.05


@pytest.fixture(scope="module")
def arms():
    try:
        metadata.distribution("example-robot-data")
    except metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    pytest.importorskip("coal")
    return PublishedArm.both("Panda")


def test_what_is_swept_holds_what_is_seen(arms):
    arm = arms["auto"]
    for link, real in zip(arm.machine.links, arm.real.links, strict=True):
        if not real.has_geometry:
            continue
        corners = link.triangles
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        out = [
            ((real.vertices - corner) @ normal).max()
            for corner, normal in zip(corners[:, 0], normals, strict=True)
        ]
        assert max(out) < 1e-5 and link.seen is real
    assert all(link.seen is None for link in arms["collision"].machine.links)


def test_joints_are_drawn_within_their_limits_and_fingers_do_not_turn(arms):
    arm, rng = arms["auto"], np.random.default_rng(1)
    for _ in range(20):
        arm.machine.checked(arm.draw(rng))
    assert len(turning(arm.machine)) == 7


def test_a_ball_is_met_where_stepping_along_the_motion_meets_it(arms):
    arm, rng, met = arms["auto"], np.random.default_rng(2), []
    for _ in range(4):
        joints = arm.draw(rng)
        ball = arm.beside(joints, (RADIUS_M + 0.005, RADIUS_M + 0.01), rng)
        if arm.distance(joints, ball) <= RADIUS_M:
            continue
        for name in turning(arm.machine)[:4]:
            motion = Motion(name, 1, 0.1)
            steps = np.arange(0.0, min(0.1, arm.machine.joint(name).upper - joints[name]), 0.01)
            near = min(arm.distance({**joints, name: joints[name] + step}, ball) for step in steps)
            meets = arm.meets(joints, motion, ball, RADIUS_M)
            if abs(near - RADIUS_M) > 0.008:
                assert meets == (near < RADIUS_M)
                met.append(meets)
    assert True in met and False in met


def test_no_hand_is_within_a_hollow_shell(arms):
    arm = arms["auto"]
    joints = dict.fromkeys(arm.machine.joint_names, 0.0) | {"panda_joint4": -1.0}
    placed = arm.machine.world_from_links(joints)
    inside = placed["panda_link1"][:3, :3] @ (0.0, -0.03, 0.0) + placed["panda_link1"][:3, 3]
    assert not arm.is_in_the_open(joints, inside)
    assert arm.is_in_the_open(joints, inside + (0.4, 0.0, 0.0))


def test_each_published_arm_is_a_file_of_the_package(arms):
    assert all((robots_folder() / path).is_file() for path in PUBLISHED.values())
