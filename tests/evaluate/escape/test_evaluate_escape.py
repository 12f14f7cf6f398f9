"""Poses close beside an object: how they are made, what leads away, and how rows sum up."""

import numpy as np
import pytest

from elbowroom.evaluate.escape.escape import DUE, escape_summary, leads_away
from elbowroom.evaluate.escape.poses import GAPS_M, NEAR, Scene, pose_beside
from elbowroom.motion import Motion
from elbowroom.simulate import Solid
from elbowroom.simulate.shapes import box, join
from reference import motion_machines as machines
from reference.motion_machines import HOME, room

MOTIONS = tuple(
    Motion(joint, way, s) for joint, s in (("slide", 0.05), ("turn", 0.1), ("nod", 0.2)) for way in (1, -1)
)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    arm = machines.slider_and_arm(tmp_path_factory.mktemp("arm"))
    wall = Solid("wall", join([box((0.2, 0.055, 0.3), (0.4, 0.1, 0.8))]), np.eye(4))
    return Scene.of("arm, by a wall", arm, MOTIONS, (wall,), room(0.05))


def test_a_pose_beside_something_has_a_gap_of_the_size_asked_for(scene):
    rng = np.random.default_rng(0)
    for _ in range(3):
        joints, gap = pose_beside(scene, rng)
        assert GAPS_M[0] * (1 - NEAR) <= gap <= GAPS_M[1] * (1 + NEAR)
        assert scene.truth.gap(joints) == pytest.approx(gap, abs=1e-9)


def test_what_leads_away_is_told_from_what_leads_along_and_into(scene):
    # the arm along x, 5 mm beside the wall
    turn, back, along = Motion("turn", 1, 0.1), Motion("turn", -1, 0.1), Motion("slide", 1, 0.05)
    assert scene.truth.gap(HOME) == pytest.approx(0.005, abs=1e-6)
    assert scene.truth.until_contact(HOME, turn).touches and not leads_away(scene, HOME, turn)
    assert leads_away(scene, HOME, Motion("turn", -1, 0.5))
    # it stays near: no way out
    assert not leads_away(scene, HOME, along)
    assert not leads_away(scene, HOME, Motion("turn", -1, 1e-3)) and back.joint == "turn"
    # where the joint ends before S nothing is said
    assert not leads_away(scene, {**HOME, "turn": -1.95}, back)


def test_gaps_are_those_of_links_that_move(scene):
    gaps = scene.truth.gaps(HOME, "turn", 0.035)
    assert gaps["arm", "wall"] == pytest.approx(0.005, abs=1e-6)
    assert scene.truth.gaps(HOME, "nod", 0.001) == {}


def test_rows_sum_up_by_machine():
    def row(scene, level, leads, beyond=False):
        said = {"scene": scene, "pose": 1, "gap_mm": 2.0, "level": level, "leads_away": leads}
        return {**said, "escapes": leads, "beyond": beyond, "touching": False}

    rows = [row("one, a", "stop", True), row("one, b", "clear", True), row("two, a", "stop", False, True)]
    every, one, two = escape_summary(rows)
    assert [each["machine"] for each in (every, one, two)] == ["all", "one", "two"]
    assert (every["motions"], every["leads_away"], every["refused"], every["beyond"]) == (3, 2, 1, 1)
    assert (one["refused_pct"], two["refused_pct"], two["beyond"]) == (50.0, 0.0, 1)
    assert {due.key for due in DUE} <= set(every)
