"""Boxes of joint positions beside plain samples of them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry.kernels.bits import plain
from elbowroom.machine import Machine
from elbowroom.motion.contacts import pairs_of, parts_of
from elbowroom.motion.kernels.beside import Box, Closing, Cutting, block_in_box, moves, pair_in_box
from elbowroom.motion.kernels.touched import NOTHING
from elbowroom.motion.meeting import Meeting
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import volume_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import nothing_in, room, touched_by_ball

GRID = room(0.1)
CUTTING = Cutting(0.1 / 16, 20_000)
halves = st.tuples(st.floats(0, 0.2), st.floats(0, 0.6), st.floats(0, 0.5))
middles = st.tuples(st.floats(-0.3, 0.3), st.floats(-1.2, 1.2), st.floats(-0.4, 0.4))
balls = st.tuples(
    st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(-0.2, 1.0)), st.floats(0.05, 0.3)
)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def in_box(middle, half, count, seed=0):
    """Corners of a box, and places in it."""
    rng = np.random.default_rng(seed)
    shares = np.concatenate([rng.choice([-1.0, 1.0], (count // 2, 3)), rng.uniform(-1, 1, (count // 2, 3))])
    return np.asarray(middle) + shares * np.asarray(half)


@settings(max_examples=20)
@given(middles, halves)
def test_no_point_moves_farther_in_a_box_than_is_said(arm, middle, half):
    skin, tree = skin_of(arm, 0.1), arm.tree
    here = arm.world_from_link_array(np.array([middle]))[0]
    by_joint = np.zeros(3)
    bounds = []
    for link, centre, radius in zip(skin.link, skin.centre, skin.radius, strict=True):
        place = tuple(here[link][:3, :3] @ centre + here[link][:3, 3])
        bounds.append(
            plain(moves)(tree, here, np.array(half), (link, -1), place, radius + skin.cover, by_joint)
        )
        assert by_joint.sum() == pytest.approx(bounds[-1])
    for there in arm.world_from_link_array(in_box(middle, half, 20)):
        change = (there - here)[skin.link[skin.cluster_of]][:, :3]
        moved = np.linalg.norm(
            np.einsum("nij,nj->ni", change[:, :, :3], skin.points) + change[:, :, 3], axis=1
        )
        assert (moved <= np.array(bounds)[skin.cluster_of] + 1e-6).all()


@settings(max_examples=40)
@given(middles, halves, st.lists(balls, min_size=1, max_size=2))
def test_what_meets_a_block_anywhere_in_a_box_is_found(arm, middle, half, solids):
    blocked = nothing_in(GRID)
    for ball in solids:
        blocked |= touched_by_ball(GRID, *ball)
    skin, volume = skin_of(arm, 0.1), volume_of(FreeSpace.from_occupied(GRID, blocked))
    box = Box(np.array(middle), np.array(half))
    asked = np.arange(len(skin.link), dtype=np.int32)
    kind, cluster, place = block_in_box(arm.tree, arm.world_from_base, skin, box, volume, asked, CUTTING)
    if kind != NOTHING:
        assert 0 <= cluster < len(skin.link)
        assert blocked[tuple(GRID.index_of(place))]
        return
    for there in arm.world_from_link_array(in_box(middle, half, 20)):
        pose = there[skin.link[skin.cluster_of]]
        points = np.einsum("nij,nj->ni", pose[:, :3, :3], skin.points) + pose[:, :3, 3]
        index = np.floor((points - GRID.lower_m) / GRID.voxel_size_m).astype(int)
        assert not blocked[tuple(index.T)].any()


def test_a_box_of_one_place_is_blocked_only_where_that_place_is(arm):
    place = np.zeros(3)
    skin, asked = skin_of(arm, 0.1), np.arange(len(skin_of(arm, 0.1).link), dtype=np.int32)
    for x, is_blocked in ((0.68, True), (0.75, False)):
        # the hand's front is at x = 0.69
        blocked = touched_by_ball(GRID, (x + 0.1, 0.05, 0.65), 0.099)
        volume = volume_of(FreeSpace.from_occupied(GRID, blocked))
        box = Box(np.array([0.0, 0.0, 0.0]), np.zeros(3))
        found = block_in_box(arm.tree, arm.world_from_base, skin, box, volume, asked, CUTTING)
        assert (found[0] != NOTHING) is is_blocked
    assert not place.any()


def test_little_effort_errs_on_the_side_of_blocked(arm):
    skin, asked = skin_of(arm, 0.1), np.arange(len(skin_of(arm, 0.1).link), dtype=np.int32)
    volume = volume_of(FreeSpace.from_occupied(GRID, touched_by_ball(GRID, (1.2, 0.9, 0.9), 0.05)))
    box = Box(np.zeros(3), np.array([0.2, 1.0, 0.5]))
    kinds = [
        block_in_box(arm.tree, arm.world_from_base, skin, box, volume, asked, Cutting(0.1 / 16, most))[0]
        for most in (1, 20_000)
    ]
    assert kinds[0] != NOTHING and kinds[1] == NOTHING


FOLDING = """<robot name="folding">
<link name="base"><collision><origin xyz="0 0 -0.1"/><geometry><box size="0.3 0.3 0.2"/></geometry></collision></link>
<link name="one"><collision><origin xyz="0.3 0 0.1"/><geometry><box size="0.6 0.1 0.1"/></geometry></collision></link>
<link name="two"><collision><origin xyz="0.25 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></collision></link>
<joint name="a" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" effort="0" velocity="1"/></joint>
<joint name="b" type="revolute"><parent link="one"/><child link="two"/><origin xyz="0.6 0 0.1"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="0" velocity="1"/></joint>
</robot>"""


@settings(max_examples=30)
@given(st.floats(-2, 2), st.floats(0, 2.6), st.floats(0, 0.3), st.floats(0, 0.6))
def test_links_that_meet_anywhere_in_a_box_are_found(folding, a, b, half_a, half_b):
    trimesh = pytest.importorskip("trimesh")
    pairs = pairs_of(folding.anywhere)
    start = folding.positions({"a": 0.0, "b": 0.0})
    now = Meeting.of(folding, folding.world_from_link_array(start[None])[0]).now
    rows = list(zip(pairs.bodies.one.tolist(), pairs.bodies.other.tolist(), strict=True))
    pair = rows.index((0, 2))
    assert now.apart[pair] > 0
    closing = Closing(pair, 0, parts_of(folding.shape), 0.0, pairs.bodies.met)
    box = Box(np.array([a, b]), np.array([half_a, half_b]))
    meets = pair_in_box(
        folding.tree, folding.world_from_base, pairs, closing, box, Cutting(0.004, 4_000), np.zeros(3)
    )
    boxes = [trimesh.creation.box((0.3, 0.3, 0.2)), trimesh.creation.box((0.4, 0.1, 0.1))]
    touched = False
    for turn in np.linspace(b - half_b, b + half_b, 9):
        placed = folding.world_from_links({"a": np.clip(a, -3, 3), "b": float(np.clip(turn, -3, 3))})
        poses = [placed["base"].copy(), placed["two"].copy()]
        poses[0][:3, 3] += poses[0][:3, :3] @ [0, 0, -0.1]
        poses[1][:3, 3] += poses[1][:3, :3] @ [0.25, 0, 0]
        points = poses[1][:3, :3] @ (boxes[1].sample(200, seed=1).T) + poses[1][:3, 3:]
        inside = np.abs(poses[0][:3, :3].T @ (points - poses[0][:3, 3:])) < [[0.15], [0.15], [0.1]]
        touched |= bool(inside.all(axis=0).any())
    assert meets or not touched
    if meets:
        # stretched out, the second link is 0.5 m from the base
        assert b + half_b > 1.0


@pytest.fixture(scope="module")
def folding(tmp_path_factory):
    path = tmp_path_factory.mktemp("folding") / "folding.urdf"
    path.write_text(FOLDING)
    return replace(Machine.from_urdf(path))
