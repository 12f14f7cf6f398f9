"""How far joints carry samples in a box, beside plain places of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry.kernels.bits import plain
from elbowroom.motion.kernels.beside import Box, Cutting, block_in_box
from elbowroom.motion.kernels.sway import Sway, sway, sways_into
from elbowroom.motion.kernels.touched import NOTHING
from elbowroom.motion.kernels.triangles import triangle_meets_box
from elbowroom.motion.kernels.volume import meets_in_box
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import volume_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import room, touched_by_box

GRID = room(0.1)
halves = st.tuples(st.floats(0, 0.2), st.floats(0, 0.6), st.floats(0, 0.5))
middles = st.tuples(st.floats(-0.3, 0.3), st.floats(-1.2, 1.2), st.floats(-0.4, 0.4))
numbers = st.floats(-1.0, 1.0)
points = st.tuples(numbers, numbers, numbers)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


@settings(max_examples=20)
@given(middles, halves, st.integers(0, 1000), st.floats(0.0, 0.05))
def test_no_point_of_a_ball_goes_farther_along_a_direction_than_is_said(arm, middle, half, seed, size):
    rng, skin = np.random.default_rng(seed), skin_of(arm, 0.1)
    here = arm.world_from_link_array(np.array([middle]))[0]
    there = arm.world_from_link_array(middle + rng.uniform(-1, 1, (30, 3)) * half)
    ways = np.empty((len(arm.links), 3))
    for cluster in rng.choice(len(skin.link), 5):
        link, own = skin.link[cluster], skin.centre[cluster]
        place = here[link][:3, :3] @ own + here[link][:3, 3]
        count, rest = plain(sway)(arm.tree, here, np.array(half), link, (*place, size), ways)
        beyond = rng.normal(size=(30, 3))
        of_ball = own + size * beyond / np.linalg.norm(beyond, axis=1, keepdims=True)
        turned = np.einsum("nij,nj->ni", there[:, link, :3, :3], of_ball) + there[:, link, :3, 3]
        moved = turned - (of_ball @ here[link][:3, :3].T + here[link][:3, 3])
        for direction in rng.normal(size=(10, 3)):
            direction /= np.linalg.norm(direction)
            reach = np.abs(ways[:count] @ direction).sum() + rest
            assert (np.abs(moved @ direction) <= reach + 1e-9).all()


@settings(max_examples=60)
@given(st.tuples(points, points, points), points, st.lists(points, max_size=3), st.floats(0.0, 0.1))
def test_a_triangle_that_is_carried_into_a_cube_may_meet_it(triangle, middle, ways, rest):
    triangle, ways = np.array(triangle), 0.3 * np.array(ways).reshape(-1, 3)
    swayed, half = Sway(ways, len(ways), rest), 0.15
    met = False
    for shares in np.stack(np.meshgrid(*[np.linspace(-1, 1, 5)] * 3), axis=-1).reshape(-1, 3):
        carried = triangle + shares[: len(ways)] @ ways
        met |= plain(triangle_meets_box)(carried, *middle, half)
    may = plain(sways_into)(triangle, *middle, half, swayed)
    assert may or not met
    if not len(ways) and rest == 0.0:
        assert may == met


@settings(max_examples=60)
@given(points, points, st.integers(0, 1000))
def test_a_box_is_asked_of_all_voxels_that_it_touches_and_of_no_others(middle, half, seed):
    rng = np.random.default_rng(seed)
    blocked = rng.random(GRID.shape) < 0.003
    volume, half = volume_of(FreeSpace.from_occupied(GRID, blocked)), np.abs(half) / 4
    met = plain(meets_in_box)(volume.words, volume.cubes, volume.lattice, middle, tuple(half))
    # where a side lies on one of a voxel, rounding decides: whoever asks grows the box by more than that
    assert met or not _meets(blocked, np.array(middle), half - 1e-9)
    assert not met or _meets(blocked, np.array(middle), half + 1e-9)


def _meets(blocked, middle, half):
    low, high = ((middle + side * half - GRID.lower_m) / GRID.voxel_size_m for side in (-1, 1))
    if (low < 0).any() or (high > GRID.shape).any():
        return True
    i, j, k = (slice(int(a), int(b) + 1) for a, b in zip(low, high, strict=True))
    return bool(blocked[i, j, k].any())


def test_what_slides_along_a_wall_is_clear_of_it_at_once(arm):
    # the hand's front is at x = 0.69 and it is 0.1 wide: the wall begins half a voxel beside it
    wall = touched_by_box(GRID, (-1.4, 0.11, 0.01), (1.4, 0.19, 0.99))
    skin, volume = skin_of(arm, 0.1), volume_of(FreeSpace.from_occupied(GRID, wall))
    hand = np.flatnonzero(skin.link == arm.link_names.index("hand")).astype(np.int32)
    box = Box(np.zeros(3), np.array([0.3, 0.0, 0.0]))
    kind, _, _ = block_in_box(arm.tree, arm.world_from_base, skin, box, volume, hand, Cutting(0.1 / 16, 40))
    assert kind == NOTHING
    nearer = Box(np.zeros(3), np.array([0.3, 0.3, 0.0]))
    assert (
        block_in_box(arm.tree, arm.world_from_base, skin, nearer, volume, hand, Cutting(0.1 / 16, 40))[0]
        != NOTHING
    )
