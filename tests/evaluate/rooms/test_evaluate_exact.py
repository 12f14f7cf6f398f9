"""Exact travel against cases known in closed form, and against the plain search of the tests of motion."""

import math
import sys

import numpy as np
import pytest

from elbowroom.errors import ElbowroomError, MachineError
from elbowroom.machine import Machine
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.motion import Motion
from elbowroom.simulate import Solid
from elbowroom.simulate.shapes import box, ellipsoid, join
from reference.motion_machines import HOME, slider_and_arm

coal = pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")

from elbowroom.evaluate.rooms.exact import NEAR_M, ExactTravel  # noqa: E402

FOLLOWED = """<robot name="followed"><link name="base"/>
<link name="a"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link><link name="b"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="0" velocity="1"/></joint>
<joint name="also" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="0" velocity="1"/><mimic joint="turn"/></joint></robot>"""


def solid(name, shape, **more):
    return Solid(name, join([shape]), np.eye(4), **more)


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    """A cart of 0.3 m in x at z = 0.3, an arm of 0.6 x 0.1 x 0.12 m in x at z = 0.5, a ball at its end."""
    return slider_and_arm(tmp_path_factory.mktemp("machine"))


def test_a_box_slides_until_it_touches_a_box(machine):
    # the cart's front is at x = 0.15, the wall's at 0.4
    wall = solid("wall", box((0.4, -0.5, 0.2), (0.5, 0.5, 0.4)))
    far = solid("far wall", box((0.45, -0.5, 0.2), (0.5, 0.5, 0.4)))
    contact = ExactTravel(machine, [far, wall]).until_contact(HOME, Motion("slide", +1, 0.1))
    assert contact.travel == pytest.approx(0.25, abs=2 * NEAR_M)
    assert contact.travel <= 0.25
    assert (contact.link, contact.solid, contact.speed, contact.touches) == ("cart", "wall", 1.0, True)


def test_an_arm_turns_until_its_side_touches_a_ball(machine):
    # the side is 0.05 m from the middle line, so a ball is met where its middle is 0.15 m from that line
    ball = solid("ball", ellipsoid((0.0, 0.4, 0.5), (0.1,) * 3, rows=40, columns=80))
    contact = ExactTravel(machine, [ball]).until_contact(HOME, Motion("turn", +1, 0.4))
    exact = math.pi / 2 - math.asin(0.15 / 0.4)
    assert exact <= contact.travel + NEAR_M
    assert contact.travel == pytest.approx(exact, abs=2e-3)
    assert (contact.link, contact.solid) == ("arm", "ball")
    # it touches where the tangent is, a little nearer to the axis than the ball's middle
    assert contact.speed == pytest.approx(math.hypot(math.sqrt(0.4**2 - 0.15**2), 0.05), abs=0.01)


def test_nothing_in_the_way_is_the_reach_or_the_limit(machine):
    aside = solid("aside", box((-1, 1, 0), (1, 1.1, 1)))
    truth = ExactTravel(machine, [aside])
    free = truth.until_contact(HOME, Motion("slide", -1, 0.05))
    assert (free.travel, free.length, free.touches) == (0.25, 0.25, False)
    capped = truth.until_contact(HOME | {"slide": 0.4}, Motion("slide", +1, 0.05))
    assert capped.travel == capped.length == pytest.approx(0.1)


def test_the_machine_and_links_that_stand_still_are_not_in_the_way(machine):
    beside = solid("base's neighbour", box((0.1, -0.1, -0.1), (0.11, 0.1, 0.1)))
    itself = solid("itself", box((0.2, -0.5, 0.2), (0.5, 0.5, 0.4)), is_machine=True)
    assert not ExactTravel(machine, [beside, itself]).until_contact(HOME, Motion("slide", +1, 0.04)).touches


def test_the_gap_is_the_distance_of_the_nearest_pair(machine):
    truth = ExactTravel(machine, [solid("wall", box((0.4, -0.5, 0.2), (0.5, 0.5, 0.4)))])
    # the arm passes over the wall: 0.44 against 0.4
    assert truth.gap(HOME) == pytest.approx(0.04)
    assert truth.gap(HOME, enough_m=0.03) == 0.03
    assert ExactTravel(machine, []).gap(HOME) == math.inf
    # two meshes that meet have no gap
    assert ExactTravel(machine, [solid("in the arm", box((0.2, 0, 0.4), (0.3, 0.3, 0.6)))]).gap(HOME) == 0


def test_it_agrees_with_a_plain_search_over_the_whole_c_arm():
    from reference import motion_exact

    machine = ceiling_c_arm()
    trees = motion_exact.meshes_of(machine)
    rng = np.random.default_rng(5)
    touched = 0
    for _ in range(12):
        joints = {j.name: rng.uniform(0.5 * j.lower, 0.5 * j.upper) for j in machine.joints}
        motion = Motion(str(rng.choice(machine.joint_names)), int(rng.choice([-1, 1])), 0.1)
        # where some point of the C will be
        ahead = joints | {motion.joint: joints[motion.joint] + motion.direction * 0.2}
        place = machine.world_from_links(ahead)["c_arc"]
        vertices = machine.links[machine.link_names.index("c_arc")].vertices
        point = place[:3, :3] @ rng.choice(vertices) + place[:3, 3]
        centre, size = point + rng.uniform(-0.1, 0.1, 3), rng.uniform(0.05, 0.2, 3)
        solids = [motion_exact.box(centre, size)]
        if motion_exact.gap(trees, machine.world_from_links(joints), trees, solids)[0] < 0.01:
            continue
        ours = ExactTravel(machine, [solid("box", box(centre - size / 2, centre + size / 2))])
        contact = ours.until_contact(joints, motion)
        plain, speed = motion_exact.travel_until_contact(
            machine, trees, joints, motion, contact.length, solids
        )
        assert contact.touches == (speed is not None)
        assert contact.travel == pytest.approx(plain, abs=1e-4)
        touched += contact.touches
    assert touched >= 2


def test_a_joint_that_others_follow_is_refused(tmp_path):
    path = tmp_path / "followed.urdf"
    path.write_text(FOLLOWED)
    truth = ExactTravel(Machine.from_urdf(path), [])
    with pytest.raises(MachineError, match="turn has followers"):
        truth.until_contact({"turn": 0.0}, Motion("turn", 1, 0.1))


def test_without_coal_the_extra_is_named(machine, monkeypatch):
    monkeypatch.setitem(sys.modules, "coal", None)
    with pytest.raises(ElbowroomError, match=r"-m pip install .*coal"):
        ExactTravel(machine, [])
