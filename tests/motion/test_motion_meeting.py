"""A machine that meets itself; the peer is mesh distance (coal)."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.motion import Cause, JointPath, Level, Motion, check_motion
from elbowroom.motion.contacts import pairs_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import contact_machines as machines
from reference.contact_machines import joint, link
from reference.motion_machines import nothing_in, room

GRID = room(0.05)
ANYTHING = ("*", "*")
EARLY_M = 2e-3
"""Links are told to meet no farther apart than this."""


def empty(machine, joints):
    return FreeSpace.from_occupied(GRID, nothing_in(GRID)).without(machine, joints)


def verdict(machine, joints, motion):
    return check_motion(empty(machine, joints), machine, joints, motion)


@pytest.fixture(scope="module")
def with_post(tmp_path_factory):
    return machines.arm_and_post(tmp_path_factory.mktemp("post"))


@pytest.fixture(scope="module")
def folding(tmp_path_factory):
    return machines.three_links(tmp_path_factory.mktemp("fold"))


def names_of(machine):
    pairs = pairs_of(machine)
    return {
        frozenset((machine.link_names[a], machine.link_names[b]))
        for a, b in zip(pairs.sampled, pairs.other, strict=True)
    }


def test_an_arm_stops_at_its_own_post(with_post):
    found = verdict(with_post, {"turn": -1.2}, Motion("turn", 1, 0.4))
    corner = math.hypot(0.37, 0.03)
    truth = 1.2 - math.atan2(0.03, 0.37) - math.asin(0.025 / corner)
    assert truth - EARLY_M / corner < found.free_travel <= truth
    assert (found.level, found.cause, found.overridable) == (Level.INFORM, Cause.MACHINE, False)
    assert (found.link, found.other_link) == ("swing", "post")
    assert found.row()["other_link"] == "post"
    assert np.linalg.norm(np.subtract(found.place_in_world[:2], (0.37, -0.03))) < 0.08
    assert verdict(with_post, {"turn": -1.2}, Motion("turn", -1, 0.3)).level is Level.CLEAR


def test_what_stands_in_the_urdf_beside_a_machine_is_an_obstacle(tmp_path):
    table = (link("table", (0.8, 0.8, 0.05), (0, 0, -0.3)), joint("on", "base", "table", kind="fixed"))
    arm = machines.machine(
        tmp_path,
        machines.BASE,
        *table,
        link("arm", (0.5, 0.05, 0.05), (0.25, 0, 0)),
        joint("lift", "base", "arm", axis="0 1 0"),
    )
    found = verdict(arm, {"lift": 0.0}, Motion("lift", 1, 0.3))
    assert (found.cause, {found.link, found.other_link}) == (Cause.MACHINE, {"arm", "table"})
    truth = math.atan2(0.275, 0.4) - math.asin(0.025 / math.hypot(0.275, 0.4))
    assert truth - EARLY_M / 0.48 < found.free_travel <= truth


def test_two_arms_on_a_path_meet_in_the_middle(tmp_path):
    sides = (("1", -0.3), ("2", 0.3))
    cell = machines.machine(
        tmp_path,
        link("world"),
        *(link(f"base{n}", (0.1, 0.1, 0.1)) for n, _ in sides),
        *(link(f"arm{n}", (0.4, 0.06, 0.06), (0.25, 0, 0)) for n, _ in sides),
        *(joint(f"fixed{n}", "world", f"base{n}", (0, y, 0), kind="fixed") for n, y in sides),
        *(joint(f"r{n}", f"base{n}", f"arm{n}", (0, 0, 0.1)) for n, _ in sides),
    )
    still = {"r1": 0.0, "r2": 0.0}
    found = verdict(cell, still, JointPath([{"r1": 1.4, "r2": -1.4}], 0.5))
    assert (found.cause, {found.link, found.other_link}) == (Cause.MACHINE, {"arm1", "arm2"})
    assert 0.55 < found.free_travel <= 0.67
    assert verdict(cell, still, Motion("r1", 1, 0.4)).level is Level.CLEAR


def test_links_that_move_as_one_do_not_meet(with_post, folding):
    # the fore arm lies over the swing's end, and turns with it
    joints = {"turn": 2.0, "bend": 2.9, "nod": 0.0}
    found = verdict(folding, joints, Motion("turn", 1, 0.1))
    assert found.cause is Cause.NONE


def test_neighbours_and_links_that_lie_in_each_other_are_not_looked_at(tmp_path):
    machine = machines.machine(
        tmp_path,
        machines.BASE,
        link("sleeve", (0.1, 0.1, 0.3), (0, 0, 0.2)),
        joint("turn", "base", "sleeve"),
        link("frame"),
        joint("to", "sleeve", "frame", (0, 0, 0.3), kind="fixed"),
        link("arm", (0.4, 0.05, 0.05), (0.2, 0, 0)),
        joint("lift", "frame", "arm", axis="0 1 0"),
        # laid around the arm's foot: in the sleeve whatever the joints are
        link("cover", (0.2, 0.2, 0.3), (0, 0, -0.1)),
        joint("about", "arm", "cover", axis="0 1 0"),
        link("far", (0.05, 0.05, 0.05), (0, 0, 0)),
        joint("tip", "arm", "far", (0.45, 0, 0)),
    )
    looked_at = names_of(machine)
    assert frozenset(("sleeve", "arm")) not in looked_at
    assert frozenset(("sleeve", "cover")) not in looked_at
    assert frozenset(("sleeve", "far")) in looked_at
    assert frozenset(("base", "arm")) in looked_at


def test_contacts_that_are_allowed_end_no_travel(with_post):
    for pair in (("swing", "post"), ("post", "sw*"), ANYTHING):
        allowing = with_post.allowing(pair)
        assert verdict(allowing, {"turn": -1.2}, Motion("turn", 1, 0.4)).cause is Cause.NONE
        assert allowing.allowances == (f"May touch each other, by the site's word: {pair[0]} and {pair[1]}",)
    with pytest.raises(MachineError, match="allowed_contacts: link 'pots' does not exist"):
        with_post.allowing(("swing", "pots"))


def test_links_that_touch_may_part_and_not_press(with_post):
    corner = math.hypot(0.37, 0.03)
    touching = {"turn": -math.atan2(0.03, 0.37) - math.asin(0.025 / corner) - 1e-3}
    assert verdict(with_post, touching, Motion("turn", -1, 0.1)).level is Level.CLEAR
    pressed = verdict(with_post, touching, Motion("turn", 1, 0.2))
    assert (pressed.level, pressed.cause) == (Level.STOP, Cause.MACHINE)
    within = {"turn": -0.05}
    assert verdict(with_post, within, Motion("turn", -1, 0.1)).level is Level.CLEAR


def test_unchecked_links_are_met_and_do_not_meet_each_other(tmp_path):
    both = machines.arm_and_post(tmp_path, unchecked_links=("swing", "post"))
    assert verdict(both, {"turn": -1.2}, Motion("turn", 1, 0.4)).cause is Cause.NONE
    one = machines.arm_and_post(tmp_path, unchecked_links=("post",))
    assert verdict(one, {"turn": -1.2}, Motion("turn", 1, 0.4)).cause is Cause.MACHINE


angle = st.floats(-2.9, 2.9)


@settings(max_examples=40)
@given(
    turn=angle,
    bend=angle,
    nod=angle,
    which=st.sampled_from(["turn", "bend", "nod"]),
    way=st.sampled_from([1, -1]),
)
def test_links_that_keep_apart_meet_no_later_than_their_meshes(folding, turn, bend, nod, which, way):
    joints, motion = {"turn": turn, "bend": bend, "nod": nod}, Motion(which, way, 0.2)
    distances, pairs = machines.Distances(folding), [tuple(pair) for pair in names_of(folding)]
    if distances.least(joints, pairs) < EARLY_M:
        return
    found = verdict(folding, joints, motion)
    travels = np.linspace(0.0, found.free_travel, 25)
    there = [{**joints, which: joints[which] + way * travel} for travel in travels]
    assert min(distances.least(at, pairs) for at in there) > 0
    if found.cause is Cause.MACHINE:
        beyond = {**joints, which: joints[which] + way * (found.free_travel + EARLY_M / 0.45)}
        near = min(distances.least(at, [(found.link, found.other_link)]) for at in (*there, beyond))
        assert near < EARLY_M
    free = verdict(folding.allowing(ANYTHING), joints, motion)
    assert found.free_travel <= free.free_travel
    assert found.level.rank <= free.level.rank
