"""Joints as a URDF says them: their order, limits and followers, and where they put the links."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.machine import Machine
from elbowroom.machine.joint_state import JointTolerance
from reference import machine_twins as naive
from reference.small_urdf import BOX, joint, urdf

SHIFTED = np.array([[0, -1, 0, 1.0], [1, 0, 0, 2], [0, 0, 1, 0.5], [0, 0, 0, 1]])


AT_REST = {"slide": 0.0, "elbow": 0.0, "grip": 0.02}


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(naive.ARM)
    return Machine.from_urdf(path, world_from_base=SHIFTED, unchecked_links=("foot",))


def two_fingers(folder, follower, leader=(0, 0.3), mimic='<mimic joint="j" multiplier="1" offset="0.02"/>'):
    limit = '<limit lower="{}" upper="{}"/>'
    second = joint("prismatic", limit.format(*follower), child="c", more=mimic).replace(
        '"j" type', '"k" type'
    )
    first = joint("prismatic", limit.format(*leader))
    return Machine.from_urdf(urdf(folder, BOX + '<link name="b"/><link name="c"/>' + first + second))


@pytest.mark.parametrize(("lower", "upper", "nearest"), [(-1, 1, 0), (0.5, 2, 0.5), (-3, -0.25, -0.25)])
def test_nearest_to_zero_keeps_to_the_limits(tmp_path, lower, upper, nearest):
    limit = f'<limit lower="{lower}" upper="{upper}"/>'
    made = Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(limit=limit)))
    assert made.nearest_to_zero() == {"j": nearest}
    made.checked(made.nearest_to_zero())


def test_names_follow_the_tree_and_followers_are_not_commanded(arm):
    assert arm.link_names == ("foot", "flange", "upper", "fore", "left", "right")
    assert arm.joint_names == ("slide", "elbow", "grip")
    assert [j.name for j in arm.joints] == ["slide", "elbow", "grip", "follow"]
    assert arm.checked_links == ("upper", "fore", "left", "right")
    assert arm.joint("slide").unit == "m"
    assert arm.joint("elbow").unit == "rad"
    assert np.allclose(arm.joint("slide").axis_in_joint, (1, 0, 0))


def test_moved_links_are_those_downstream_with_those_of_followers(arm):
    assert arm.moved_links("slide") == ("flange", "upper", "fore", "left", "right")
    assert arm.moved_links("grip") == ("left", "right")


@settings(max_examples=20)
@given(st.floats(-0.5, 0.5), st.floats(-2, 2), st.floats(0, 0.04))
def test_links_are_where_the_matrix_exponential_puts_them(arm, slide, elbow, grip):
    joints = {"slide": slide, "elbow": elbow, "grip": grip}
    expected = naive.world_from_links(arm, joints)
    for name, placed in arm.world_from_links(joints).items():
        assert np.allclose(placed, expected[name], atol=1e-12)


def test_many_configurations_are_each_as_alone(arm):
    slides = np.linspace(-0.5, 0.5, 7)
    many = arm.world_from_links({"slide": slides, "elbow": 0.3, "grip": 0.01})
    for n, slide in enumerate(slides):
        alone = arm.world_from_links({"slide": slide, "elbow": 0.3, "grip": 0.01})
        assert all(np.array_equal(many[name][n], alone[name]) for name in arm.link_names)
    assert many["fore"].shape == (7, 4, 4)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ({"slide": 0.0, "elbow": 0.0}, "'grip' has no position"),
        ({**AT_REST, "follow": 0.5}, "follow: 0.5 m, but it follows grip, which puts it at"),
        ({**AT_REST, "follow": float("nan")}, "follow: position is not finite"),
        ({**AT_REST, "grip": [0.0, 0.1], "follow": [0.0, 0.1, 0.2]}, "is out of its limits|unlike lengths"),
        ({**AT_REST, "slide": float("nan")}, "slide: position is not finite"),
        ({**AT_REST, "slide": 0.7}, r"slide: 0.7 m is out of its limits, -0.5 to 0.5 m"),
        ({**AT_REST, "elbow": -3}, r"elbow: -3 rad is out of its limits, -2 to 2 rad"),
        ({**AT_REST, "elbow": [0.0, 2.5]}, r"elbow: 2.5 rad is out"),
        ({**AT_REST, "elbow": "left"}, "elbow: 'left' is not a number"),
        ({**AT_REST, "elbow": 10**400}, "elbow: 10*0 is not a number"),
        ({**AT_REST, "elbow": [0.0, 1.0], "slide": [0.0, 0.1, 0.2]}, "unlike lengths"),
    ],
)
def test_impossible_joints_are_named(arm, joints, message):
    with pytest.raises(MachineError, match=message):
        arm.world_from_links(joints)


def test_whole_joint_states_are_taken_with_followers_and_joints_of_other_machines(arm):
    state = {**AT_REST, "follow": -0.03, "wrist_of_another": 3.0}
    placed = arm.world_from_links(state)
    assert set(arm.checked(state)) == set(arm.joint_names)
    assert all(np.array_equal(placed[name], at) for name, at in arm.world_from_links(AT_REST).items())
    with pytest.raises(MachineError, match="no joint 'wrist_of_another'; joints are slide, elbow, grip"):
        arm.require_joints(state)


@pytest.mark.parametrize("way", [-1, 1])
def test_a_position_beyond_a_limit_by_little_is_taken_as_it_is(arm, way):
    over = np.radians(0.9)
    assert arm.checked({**AT_REST, "elbow": way * (2 + over)})["elbow"] == way * (2 + over)
    with pytest.raises(MachineError, match="out of its limits"):
        arm.checked({**AT_REST, "elbow": way * (2 + np.radians(1.1))})
    strict = replace(arm, tolerance=JointTolerance(rad=0.0, m=0.0))
    with pytest.raises(MachineError, match="out of its limits"):
        strict.checked({**AT_REST, "elbow": way * (2 + over)})


@settings(max_examples=30)
@given(st.floats(-1, 1), st.floats(0.1, 1), st.sampled_from([-2.0, -1.0, 0.5, 1.0]), st.floats(-0.2, 0.2))
def test_a_leader_ends_where_the_first_of_its_followers_ends(
    tmp_path_factory, lower, span, multiplier, offset
):
    mimic = f'<mimic joint="j" multiplier="{multiplier}" offset="{offset}"/>'
    machine = two_fingers(tmp_path_factory.mktemp("fingers"), (lower, lower + span), (-0.6, 0.7), mimic)
    leader = machine.joint("j")
    ends = multiplier * np.array([leader.lower, leader.upper]) + offset
    within = (ends >= lower - 1e-9).all() and (ends <= lower + span + 1e-9).all()
    # limits that no position of the leader meets cannot be meant, and are said
    assert within or any("leave no travel" in finding.text for finding in machine.findings)
    assert -0.6 <= leader.lower < leader.upper <= 0.7


def test_a_follower_that_ends_first_cuts_its_leader(tmp_path):
    machine = two_fingers(tmp_path, (0, 0.1))
    assert (machine.joint("j").lower, machine.joint("j").upper) == pytest.approx((0, 0.08))


@pytest.mark.parametrize(
    ("lower", "upper", "kept"), [("-inf", "inf", (-np.inf, np.inf)), ("0", "1e16", (0, np.inf))]
)
def test_limits_too_wide_to_be_any_are_none_and_said(tmp_path, lower, upper, kept):
    limit = f'<limit lower="{lower}" upper="{upper}"/>'
    for kind in ("revolute", "prismatic"):
        machine = Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(kind, limit)))
        assert (machine.joint("j").lower, machine.joint("j").upper) == kept
        assert "taken for none" in machine.findings[0].text


def test_a_joint_whose_limits_are_both_zero_cannot_move_and_is_said(tmp_path):
    for limit in ('<limit lower="0" upper="0"/>', '<limit effort="1" velocity="1"/>'):
        machine = Machine.from_urdf(urdf(tmp_path, BOX + '<link name="b"/>' + joint(limit=limit)))
        assert "cannot move" in machine.findings[0].text


def test_checked_joints_come_in_the_order_of_their_names_and_take_rounding(arm):
    checked = arm.checked({"grip": 0.0, "elbow": 2.0 + 1e-9, "slide": -0.5})
    assert list(checked) == list(arm.joint_names)
