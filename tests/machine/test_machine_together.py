"""Several machines of one site as one; the peer of their meeting is mesh distance (coal)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.machine import Part, Stand
from elbowroom.machine.own_links import OwnLinks
from elbowroom.machine.together import Member, together
from elbowroom.motion import Cause, Motion, check_motion
from elbowroom.reconstruct.free_space import FreeSpace
from reference import contact_machines as machines
from reference.contact_machines import joint, link
from reference.motion_machines import nothing_in, room

GRID = room(0.05)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.machine(
        tmp_path_factory.mktemp("arm"),
        machines.BASE,
        link("upper", (0.4, 0.06, 0.06), (0.25, 0, 0)),
        joint("turn", "base", "upper", (0, 0, 0.1)),
        link("tool", (0.06, 0.06, 0.3), (0, 0, 0.1)),
        joint("bend", "upper", "tool", (0.45, 0, 0), "0 1 0"),
    )


def at(machine, x, y):
    pose = np.eye(4)
    pose[:2, 3] = x, y
    return machine.at(pose)


@pytest.fixture(scope="module")
def two(arm):
    return together([Member("left", at(arm, 0, -0.2), "left_"), Member("right", at(arm, 0, 0.2), "right_")])


UP = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.3], [0, 0, 0, 1.0]])
STILL = {"left_turn": 0.0, "left_bend": 0.0, "right_turn": 0.0, "right_bend": 0.0}


def space(machine, joints):
    return FreeSpace.from_occupied(GRID, nothing_in(GRID)).without(machine, joints)


def test_links_are_where_they_are_alone(arm, two):
    joints = {"left_turn": 0.3, "left_bend": -0.2, "right_turn": -0.9, "right_bend": 0.7}
    placed = two.world_from_links(joints)
    for side, y in (("left", -0.2), ("right", 0.2)):
        own = {
            name.removeprefix(f"{side}_"): value for name, value in joints.items() if name.startswith(side)
        }
        for name, pose in at(arm, 0, y).world_from_links(own).items():
            np.testing.assert_allclose(placed[f"{side}/{name}"], pose, atol=1e-15)
    assert two.joint_names == ("left_turn", "left_bend", "right_turn", "right_bend")
    assert two.moved_links("right_turn") == ("right/upper", "right/tool")


def test_one_machine_ends_the_travel_of_the_other_and_both_are_named(two):
    found = check_motion(space(two, STILL), two, STILL, Motion("left_turn", 1, 0.3))
    assert found.cause is Cause.MACHINE
    assert (found.link.split("/")[0], found.other_link.split("/")[0]) == ("left", "right")


angle = st.floats(-2.5, 2.5)


@settings(max_examples=30)
@given(st.tuples(angle, angle, angle, angle), st.sampled_from(sorted(STILL)), st.sampled_from([1, -1]))
def test_machines_meet_no_later_than_their_meshes(two, pose, which, way):
    joints = dict(zip(two.joint_names, pose, strict=True))
    exact = machines.Distances(two)
    across = [
        (a, b)
        for a in two.link_names
        if a.startswith("left/")
        for b in two.link_names
        if b.startswith("right/")
    ]
    if exact.least(joints, across) < 1e-3:
        return
    found = check_motion(space(two, joints), two, joints, Motion(which, way, 0.1))
    travels = np.linspace(0.0, found.free_travel, 20)
    assert min(exact.least({**joints, which: joints[which] + way * t}, across) for t in travels) > 0


def test_what_is_said_of_one_machine_stays_its_own(arm):
    left = (
        at(arm, 0, -0.4)
        .allowing(("base", "tool"))
        .standing_on(Stand.box(["upper"], (-1, -1, -1), (1, 1, 0)))
        .comparing(OwnLinks("a.srdf", (("base", "upper", "adjacent"),)))
        .with_part("tool", Part.box("plate", (0.1, 0.1, 0.01)), UP)
    )
    both = together([Member("left", left, "l_"), Member("right", at(arm, 0, 0.4))])
    assert ("left/base", "left/tool") in both.allowed_contacts
    assert both.stands[0].links == ("left/upper",) and both.parts == ("left/plate",)
    assert both.own_links.has("left/upper", "left/base") and not both.own_links.has(
        "right/upper", "right/base"
    )
    assert both.joint_names == ("l_turn", "l_bend", "turn", "bend")


def test_machines_say_what_is_wrong_with_them(arm):
    for members, words in (
        ([], "none; at least one"),
        ([Member("a", arm), Member("a", arm, "b_")], "a is there more than once"),
        (
            [Member("a", arm), Member("b", arm)],
            "a and b both have a joint turn, .* give one of them a joint_prefix",
        ),
    ):
        with pytest.raises(MachineError, match=words):
            together(members)
