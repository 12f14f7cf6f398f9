"""Poses close beside an object: how they are made, what leads away, and how rows sum up."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.evaluate.escape.escape import DUE, escape_summary, leads_away
from elbowroom.evaluate.escape.in_parts import TrueParts
from elbowroom.evaluate.escape.poses import GAPS_M, NEAR, Scene, pose_beside
from elbowroom.geometry import VoxelGrid
from elbowroom.motion import Motion
from elbowroom.reconstruct import FreeSpace
from elbowroom.simulate import Moment, Solid, true_occupancy
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


def test_parts_are_free_that_nothing_touches(scene):
    whole = FreeSpace.from_occupied(scene.grid, scene.occupied)
    space = replace(whole, source=TrueParts(scene.solids))
    finer = VoxelGrid(
        scene.grid.origin_m, tuple(4 * n for n in scene.grid.shape), scene.grid.voxel_size_m / 4
    )
    occupied = true_occupancy(finer, Moment(0.0, scene.solids, {})).occupied
    some = np.argwhere(scene.occupied)
    assert len(some) > 20
    for i, j, k in some[:: len(some) // 20].tolist():
        word = int(space.free_parts((i, j, k)))
        said = np.array([word >> n & 1 for n in range(64)], dtype=bool).reshape(4, 4, 4)
        assert (said == ~occupied[4 * i : 4 * i + 4, 4 * j : 4 * j + 4, 4 * k : 4 * k + 4]).all()
        assert whole.free_parts((i, j, k)) == 0


def test_rows_sum_up_by_space_and_machine():
    def row(scene, level, leads, beyond=False, space="voxels"):
        said = {"scene": scene, "pose": 1, "space": space, "gap_mm": 2.0, "level": level, "leads_away": leads}
        return {**said, "escapes": leads, "beyond": beyond, "touching": False}

    rows = [row("one, a", "stop", True), row("one, b", "clear", True), row("two, a", "stop", False, True)]
    rows += [row("one, a", "clear", True, space="in parts")]
    every, one, two, *fine = escape_summary(rows)
    assert [each["machine"] for each in (every, one, two)] == ["all", "one", "two"]
    assert (every["motions"], every["leads_away"], every["refused"], every["beyond"]) == (3, 2, 1, 1)
    assert (one["refused_pct"], two["refused_pct"], two["beyond"]) == (50.0, 0.0, 1)
    assert (fine[0]["space"], fine[0]["motions"], fine[0]["refused"]) == ("in parts", 1, 0)
    assert {due.key for due in DUE} <= set(every)
