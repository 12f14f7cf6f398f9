"""What is drawn: blocked space near the machine beside a naive twin, ways, light meshes, and colours told apart."""

from itertools import combinations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.motion import Level
from elbowroom.page import colours
from elbowroom.page.scene.bodies import light_mesh, link_points
from elbowroom.page.scene.near import MOST_PLACES, Planes, near_of
from elbowroom.page.scene.scene import _labels_of
from elbowroom.page.scene.ways import way_points
from elbowroom.site import Site
from reference.colour import APART, CONES, lab

NOTHING = np.zeros(0, dtype=np.bool_)


def naive(grid, free, surface, blind, machine, near_m):
    """Blocked voxels beside a free one, near a point of the machine, by kind."""
    found = {"surface": set(), "unseen": set(), "blind": set()}
    for index in np.ndindex(*grid.shape):
        if free[index]:
            continue
        beside = [
            tuple(np.add(index, step)) for step in np.vstack([np.eye(3, dtype=int), -np.eye(3, dtype=int)])
        ]
        if not any(all(0 <= n < m for n, m in zip(b, grid.shape, strict=True)) and free[b] for b in beside):
            continue
        if min(np.linalg.norm(machine - grid.centre_of(index), axis=1)) >= near_m:
            continue
        kind = "surface" if surface[index] else "blind" if blind[index] else "unseen"
        found[kind].add(index)
    return found


@settings(max_examples=25)
@given(st.integers(0, 2**31), st.integers(3, 22), st.floats(0.05, 1.0))
def test_what_is_near_is_what_the_naive_twin_finds(seed, width, near_m):
    chance = np.random.default_rng(seed)
    grid = VoxelGrid((-0.3, 0.1, 0.0), (width, 9, 7), 0.1)
    free = chance.random(grid.shape) < 0.6
    surface = ~free & (chance.random(grid.shape) < 0.4)
    blind = ~free & (chance.random(grid.shape) < 0.3)
    machine = grid.lower_m + chance.random((3, 3)) * 0.1 * np.array(grid.shape)
    planes = Planes(*(bits.pack(one, grid) for one in (free, surface, blind)), NOTHING)
    found = near_of(grid, planes, machine, near_m)
    due = naive(grid, free, surface, blind, machine, near_m)
    for kind, voxels in due.items():
        assert {tuple(int(n) for n in row) for row in getattr(found, kind)} == voxels


def test_what_was_not_looked_at_is_not_drawn_and_too_many_are_thinned_and_said():
    grid = VoxelGrid((0, 0, 0), (64, 64, 64), 0.1)
    free = np.indices(grid.shape).sum(axis=0) % 2 == 0
    words, none = bits.pack(free, grid), bits.empty(grid)
    every = near_of(grid, Planes(words, none, none, NOTHING), np.zeros((0, 3)))
    assert every.count == MOST_PLACES and every.thinned == 64**3 // 2
    looked = np.zeros(bits.word_count(grid), dtype=np.bool_)
    assert near_of(grid, Planes(words, none, none, looked), np.zeros((0, 3))).count == 0
    looked[0] = True
    some = near_of(grid, Planes(words, none, none, looked), np.zeros((0, 3)))
    assert some.count == 32 and some.thinned is None and (some.unseen < 4).all()


def test_a_way_lies_where_the_links_come_and_nothing_that_stands_still_is_in_it():
    machine = Site.simulated_room().machine()
    joints = dict.fromkeys(machine.joint_names, 0.0) | {"long": 0.2}
    joints = {
        name: float(np.clip(v, machine.joint(name).lower, machine.joint(name).upper))
        for name, v in joints.items()
    }
    points = link_points(machine)
    way = way_points(machine, points, joints, ("long", 0.3))
    still = way_points(machine, points, joints, ("long", 0.0))
    assert len(way) > 100 and len(still) == 0
    before = machine.world_from_links(joints)["rail"]
    rail = points["rail"] @ before[:3, :3].T + before[:3, 3]
    assert way[:, 0].max() - way[:, 0].min() > 0.3 and len(rail)


def test_a_fine_mesh_becomes_light_and_stays_where_it_was():
    ball = trimesh.creation.icosphere(subdivisions=6)
    vertices, faces = light_mesh(ball.vertices, ball.faces.astype(np.int32), 2000)
    assert 100 < len(faces) <= 2000
    assert abs(np.linalg.norm(vertices[faces].reshape(-1, 3), axis=1) - 1).max() < 1e-3


# colours


@pytest.mark.parametrize("cones", CONES)
def test_colours_that_mean_something_are_told_apart_by_every_eye(cones):
    known = {
        "surface": colours.SURFACE,
        "unseen": colours.UNSEEN,
        "blind": colours.BLIND,
        "contact": colours.CONTACT,
        "paper": (255, 255, 255),
        **{level.name: colours.LEVELS[level] for level in Level},
    }
    seen = {name: lab(colour, CONES[cones]) for name, colour in known.items()}
    for one, other in combinations(seen, 2):
        assert np.linalg.norm(seen[one] - seen[other]) > APART, (one, other)
    well, ill = (lab(c, CONES[cones]) for c in (colours.CAMERA_WELL, colours.CAMERA_ILL))
    assert np.linalg.norm(well - ill) > APART


def test_contacts_that_lie_close_together_share_a_label_and_lose_no_name():
    a, b, c, d = (0.0, 0.0, 1.0), (0.1, 0.1, 1.0), (1.0, 0.0, 1.0), (0.0, 0.0, 1.19)
    labels = _labels_of([("long +", a), ("larm +", c), ("carc +", b), ("path", d)])
    assert labels == [("long +, carc +, path", a), ("larm +", c)]
    assert _labels_of([]) == []
