"""Parts that a machine carries."""

import numpy as np
import pytest
import trimesh

from elbowroom.errors import MachineError
from elbowroom.geometry import bits
from elbowroom.machine import Part, body_words
from elbowroom.motion import Cause, Level, Motion, check_motion
from elbowroom.reconstruct.free_space import FreeSpace
from reference.contact_machines import BASE, SWING, joint, link, machine
from reference.motion_machines import nothing_in, room, touched_by_box

GRID = room(0.025, (-0.2, -0.9, -0.2), (1.3, 0.9, 0.4))
JOINTS = {"turn": 0.0, "close": 0.0}
POSE = np.eye(4)
POSE[:3, 3] = (0.6, 0, 0)


@pytest.fixture(scope="module")
def gripper(tmp_path_factory):
    return machine(
        tmp_path_factory.mktemp("gripper"),
        BASE,
        link("arm", (0.4, 0.06, 0.06), (0.25, 0, 0)),
        joint("turn", "base", "arm", (0, 0, 0.1)),
        link("left", (0.2, 0.02, 0.02), (0.1, 0, 0)),
        joint("close", "arm", "left", (0.45, 0.08, 0), "0 1 0", "prismatic"),
        link("right", (0.2, 0.02, 0.02), (0.55, -0.08, 0)),
        joint("fixed", "arm", "right", kind="fixed"),
    )


def test_a_part_is_taken_out_with_the_machine_and_swept_with_it(gripper):
    holding = gripper.with_part("arm", Part.box("part", (0.1, 0.1, 0.1)), POSE)
    # where the part is seen: between the fingers
    seen = touched_by_box(GRID, (0.55, -0.05, 0.05), (0.65, 0.05, 0.15))
    wall = touched_by_box(GRID, (0.3, 0.4, 0.0), (0.7, 0.5, 0.2))
    motion = Motion("turn", 1, 0.2)
    space = FreeSpace.from_occupied(GRID, seen | wall)
    assert check_motion(space.without(gripper, JOINTS), gripper, JOINTS, motion).level is Level.STOP
    found = check_motion(space.without(holding, JOINTS), holding, JOINTS, motion)
    assert found.cause is Cause.SURFACE and 0.3 < found.free_travel < 0.6
    assert bits.unpack(body_words(holding, JOINTS, GRID), GRID)[seen].all()


def test_a_part_reaches_farther_than_the_hand_that_holds_it(gripper):
    long = gripper.with_part(
        "arm", Part.cylinder("rod", 0.02, 0.5), [[0, 0, 1, 0.85], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]
    )
    post = touched_by_box(GRID, (0.85, 0.4, 0.0), (0.95, 0.5, 0.2))
    space = FreeSpace.from_occupied(GRID, post)
    motion = Motion("turn", 1, 0.3)
    assert check_motion(space.without(gripper, JOINTS), gripper, JOINTS, motion).level is Level.CLEAR
    found = check_motion(space.without(long, JOINTS), long, JOINTS, motion)
    assert (found.cause, found.link) == (Cause.SURFACE, "rod")


def test_a_part_may_touch_what_holds_it_and_nothing_else(gripper):
    holding = gripper.with_part("arm", Part.box("part", (0.1, 0.14, 0.1)), POSE)
    space = FreeSpace.from_occupied(GRID, nothing_in(GRID)).without(holding, JOINTS)
    asked = [Motion(name, way, 0.02) for name in ("turn", "close") for way in (1, -1)]
    found = {
        (motion.joint, motion.direction): check_motion(space, holding, JOINTS, motion) for motion in asked
    }
    # a finger that closes on stops at what it holds, and nothing else does
    assert {key for key, verdict in found.items() if verdict.level is not Level.CLEAR} == {("close", -1)}
    stopped = found["close", -1]
    assert (stopped.cause, {stopped.link, stopped.other_link}) == (Cause.MACHINE, {"left", "part"})
    assert not holding.allowed_contacts and not holding.allowances
    # unless somebody says that it may, which every summary says
    allowing = holding.allowing(("part", "left"))
    assert check_motion(space, allowing, JOINTS, Motion("close", -1, 0.02)).level is Level.CLEAR
    assert allowing.allowances == (
        "May touch each other, as nearly always or by the site's word: part and left",
    )


def test_a_part_on_an_early_link_ends_the_way_of_the_next_one_as_a_link_would(tmp_path):
    """What is carried is as good as what is fixed: the same post in the URDF and as a part."""
    post = link("post", (0.06, 0.06, 0.6), (0.4, 0, 0.3))
    fixed = machine(tmp_path, BASE, *SWING, post, joint("stands", "base", "post", kind="fixed"))
    pose = np.eye(4)
    pose[:3, 3] = (0.4, 0, 0.3)
    bare = machine(tmp_path, BASE, *SWING)
    carried = bare.with_part("base", Part.box("post", (0.06, 0.06, 0.6)), pose)
    joints, motion = {"turn": 0.8}, Motion("turn", -1, 0.5)
    space = FreeSpace.from_occupied(GRID, nothing_in(GRID))
    verdicts = [check_motion(space.without(m, joints), m, joints, motion) for m in (fixed, carried)]
    assert all(verdict.cause is Cause.MACHINE for verdict in verdicts)
    assert verdicts[0].free_travel == pytest.approx(verdicts[1].free_travel, abs=1e-6)
    assert not carried.allowed_contacts


def test_a_part_that_the_next_link_touches_in_nearly_all_poses_may_touch_it_and_that_is_said(tmp_path):
    bare = machine(tmp_path, BASE, *SWING)
    pose = np.eye(4)
    pose[:3, 3] = (0, 0, 0.1)
    holding = bare.with_part("base", Part.cylinder("collar", 0.1, 0.1), pose)
    assert holding.allowed_contacts == (("collar", "swing"),)
    assert holding.allowances == (
        "May touch each other, as nearly always or by the site's word: collar and swing",
    )
    assert holding.without_part("collar").allowed_contacts == ()


def test_a_part_is_taken_off_again(gripper):
    holding = gripper.with_part("left", Part.box("part", (0.1, 0.1, 0.1)), POSE)
    twice = holding.with_part("part", Part.box("lid", (0.1, 0.1, 0.02)))
    assert twice.parts == ("part", "lid")
    bare = twice.without_part("lid").without_part("part")
    assert (bare.link_names, bare.parts, bare.allowed_contacts) == (gripper.link_names, (), ())
    for one, other in zip(bare.tree, gripper.tree, strict=True):
        assert np.array_equal(one, other)
    with pytest.raises(MachineError, match="carries no part 'part'; parts are none"):
        bare.without_part("part")
    # a part that hangs on another does not stay behind without it
    assert twice.without_part("part").link_names == gripper.link_names


def test_a_mesh_is_read_in_its_unit(gripper, tmp_path):
    trimesh.creation.box((100, 80, 60)).export(tmp_path / "part.stl")
    part = Part.mesh("part", tmp_path / "part.stl", 0.001)
    assert np.ptp(part.surface.vertices, axis=0) == pytest.approx((0.1, 0.08, 0.06))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda m: m.with_part("hand", Part.box("part", (1, 1, 1))), "link 'hand' does not exist"),
        (lambda m: m.with_part("arm", Part.box("left", (1, 1, 1))), "there is a link of that name"),
        (lambda m: m.with_part("arm", Part.box("part", (1, 1, 0))), "must be finite and above 0"),
        (lambda m: m.with_part("arm", Part.box("part", (1, 1))), "must be three edges"),
        (lambda m: m.with_part("arm", Part.box("part", (1, 1, 1)), np.diag([2, 1, 1, 1])), "link_from_part"),
        (lambda m: Part.mesh("part", "nowhere.stl"), "no such file"),
        (lambda m: Part.mesh("part", __file__, 0.0), "scale is 0.0"),
        (lambda m: Part.box("", (1, 1, 1)), "has no name"),
        (lambda m: Part.box("*", (1, 1, 1)), r"part '\*': a name with \* or \? would stand for other links"),
    ],
)
def test_what_cannot_be_carried_is_said(gripper, make, words):
    with pytest.raises(MachineError, match=words):
        make(gripper)


def test_a_part_that_lies_in_links_that_do_not_carry_it_is_refused(gripper):
    """What always touches is not compared: so a part may not be said to be where another link always is."""
    with pytest.raises(
        MachineError, match="part log lies in base, arm, right in all poses, which do not carry it"
    ):
        gripper.with_part("left", Part.box("log", (9, 9, 9)))
    # the link that carries it and what hangs on that it may lie in
    assert gripper.with_part("arm", Part.box("part", (0.1, 0.15, 0.1)), POSE).parts == ("part",)
