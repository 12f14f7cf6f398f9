"""How far links are from what was seen and from what nobody saw: never more than the truth, and little less."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.geometry import bits
from elbowroom.geometry.margin import Margin
from elbowroom.machine import Zone, body_samples
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.machine.stand import Stand
from elbowroom.motion import Motion, blocks_in_reach, link_distances
from elbowroom.motion.kernels.nearest import Marks, nearest
from elbowroom.motion.stride import greatest_strides
from elbowroom.reconstruct import reconstruct
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_distances as naive
from reference import motion_machines as machines
from reference import reconstruct_scenes as scenes
from reference import reconstruct_weaken as less
from reference.motion_machines import HOME, room, touched_by_box

GRID = room(0.1)
UP_TO_M = 0.4
C_ARM = ceiling_c_arm()
PLACES = st.tuples(st.floats(-0.4, 0.4), st.floats(-1.8, 1.8), st.floats(-0.9, 0.9))


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def joints_at(place):
    return dict(zip(("slide", "turn", "nod"), place, strict=True))


def space_of(seen, unseen, grid=GRID):
    """A space in which some voxels are surfaces, some are not seen, and all others are free."""
    surface, hidden = bits.pack(seen, grid), bits.pack(unseen & ~seen, grid)
    free = bits.inside(grid) & ~surface & ~hidden
    return FreeSpace(grid, free, surface, bits.empty(grid), bits.empty(grid))


def some(rng, count, grid=GRID):
    """So many voxels, anywhere."""
    mask = np.zeros(grid.shape, dtype=bool)
    mask[tuple(rng.integers(0, grid.shape, (count, 3)).T)] = True
    return mask


@settings(max_examples=10)
@given(PLACES, st.integers(0, 9999))
def test_distances_are_never_more_than_those_of_meshes_and_boxes_and_little_less(arm, place, seed):
    pytest.importorskip("coal", reason="coal is not installed; exact distance is left out")
    rng, joints = np.random.default_rng(seed), joints_at(place)
    seen, unseen = some(rng, 30), some(rng, 15)
    found = link_distances(space_of(seen, unseen), arm, joints, UP_TO_M)
    placed = arm.world_from_links(joints)
    assert [link.link for link in found.links] == [
        name for name in arm.link_names if name in arm.checked_links
    ]
    for link in found.links:
        pose, own = placed[link.link], arm.links[arm.link_names.index(link.link)]
        vertices = own.vertices @ pose[:3, :3].T + pose[:3, 3]
        to_seen, to_hidden = (
            naive.convex_to_boxes(vertices, own.faces, GRID, marked) for marked in (seen, unseen & ~seen)
        )
        for nearest_one, truth in (
            (link.seen, to_seen),
            (link.unseen, min(to_hidden, naive.to_outside(vertices, GRID))),
        ):
            assert nearest_one.distance_m <= truth + 1e-9
            if nearest_one.is_there:
                assert truth - nearest_one.distance_m <= found.slack_m + 1e-9
            else:
                assert nearest_one.distance_m == UP_TO_M
    assert found.seen.distance_m == min(link.seen.distance_m for link in found.links)
    assert found.unseen.distance_m == min(link.unseen.distance_m for link in found.links)


@settings(max_examples=30)
@given(PLACES, st.integers(0, 9999), st.sampled_from((0, 3, 300)), st.booleans(), st.floats(0.05, 3.0))
def test_the_kernel_finds_what_is_found_by_looking_at_every_pair(arm, place, seed, count, outside, reach):
    rng = np.random.default_rng(seed)
    marked = some(rng, count)
    words, samples = bits.pack(marked, GRID), body_samples(arm, 0.1)
    marks = Marks(bits.lattice(GRID), words, (words.reshape(-1, 64) != 0).any(axis=1), outside)
    placed = arm.world_from_link_array(arm.positions(joints_at(place))[None])[0]
    for row in np.unique(samples.cluster_link):
        points = samples.points[samples.point_link == row].astype(float)
        points = points @ placed[row, :3, :3].T + placed[row, :3, 3]
        truth = min(naive.to_boxes(points, GRID, marked), reach)
        if outside:
            truth = min(truth, naive.to_outside(points, GRID))
        first, last = np.searchsorted(samples.cluster_link, [row, row + 1])
        found, kind = nearest(placed[row], samples.clusters, first, last, marks, reach, np.zeros(3))
        assert found == pytest.approx(truth, abs=1e-9)
        assert (kind == 0) == (truth == reach)


@settings(max_examples=25)
@given(PLACES, st.integers(0, 9999))
def test_more_blocked_voxels_are_never_farther(arm, place, seed):
    rng = np.random.default_rng(seed)
    seen, unseen = some(rng, 20), some(rng, 20)
    before = link_distances(space_of(seen, unseen), arm, joints_at(place), UP_TO_M)
    after = link_distances(
        space_of(seen | some(rng, 30), unseen | some(rng, 30)), arm, joints_at(place), UP_TO_M
    )
    for one, other in zip(before.links, after.links, strict=True):
        assert other.seen.distance_m <= one.seen.distance_m
        assert other.blocked.distance_m <= one.blocked.distance_m


@settings(max_examples=12)
@given(st.integers(0, 9999), st.sets(st.sampled_from(less.WAYS), min_size=1))
def test_less_evidence_never_gives_a_greater_distance(arm, seed, ways):
    rng = np.random.default_rng(seed)
    eyes = [(2.5 * np.cos(a), 2.5 * np.sin(a), rng.uniform(0.0, 2.0)) for a in rng.uniform(0, 2 * np.pi, 5)]
    cameras = [
        scenes.camera_at(f"c{n}", eye, (0.2, 0.0, 0.4), size=(80, 60), focal=55.0)
        for n, eye in enumerate(eyes)
    ]
    centres = rng.uniform(GRID.lower_m, GRID.upper_m, (20, 3))
    scene = scenes.Scene(balls=np.column_stack([centres, rng.uniform(0.1, 0.2, 20)]))
    frames = [replace(scenes.frame_of(camera, scene), stamp_ns=less.NOW) for camera in cameras]
    margin = less.some_margin(rng)

    def distances(given, within: Margin):
        space = reconstruct(
            GRID, cameras, given, margin=within, now_ns=less.NOW, max_age_ns=less.AGE, looks=False
        )
        return link_distances(space, arm, HOME, UP_TO_M)

    before = distances(frames, margin)
    after = distances(*less.weakened(rng, frames, margin, ways))
    for one, other in zip(before.links, after.links, strict=True):
        assert other.blocked.distance_m <= one.blocked.distance_m


def test_what_lies_wholly_in_a_link_is_at_no_distance(tmp_path):
    fine = room(0.025)
    arm = machines.slider_and_arm(tmp_path)
    inside = touched_by_box(fine, (0.30, -0.01, 0.49), (0.31, 0.01, 0.51))
    nothing = np.zeros(fine.shape, dtype=bool)
    for seen, unseen, which in ((inside, nothing, "seen"), (nothing, inside, "unseen")):
        found = link_distances(space_of(seen, unseen, fine), arm, HOME, 0.2)
        (one,) = (link for link in found.links if link.link == "arm")
        assert getattr(one, which).distance_m == 0.0 and getattr(one, which).is_there


def test_where_no_camera_was_asked_there_may_be_anything(arm):
    nothing = np.zeros(GRID.shape, dtype=bool)
    space = space_of(nothing, np.ones(GRID.shape, dtype=bool)).without(arm, HOME)
    asked = link_distances(space, arm, HOME, UP_TO_M)
    unasked = replace(space, looked_at=np.zeros(bits.word_count(GRID), dtype=bool))
    found = link_distances(unasked, arm, HOME, UP_TO_M)
    assert not asked.seen.is_there
    assert found.seen.distance_m == found.unseen.distance_m == asked.unseen.distance_m < 0.1


def test_all_that_is_as_near_as_is_asked_is_looked_at(arm):
    grid, motions = room(0.05), [Motion("nod", +1, 0.01)]
    space = space_of(*[np.zeros(grid.shape, dtype=bool)] * 2, grid).without(arm, HOME)
    for look_m in (0.0, 0.4):
        reach = blocks_in_reach(grid, arm, HOME, motions, look_m)
        dark = replace(space, free_words=np.where(reach, space.free_words, 0), looked_at=reach)
        found = link_distances(dark, arm, HOME, 0.4)
        assert found.seen.is_there == (look_m == 0.0)


def test_a_link_is_far_from_what_it_may_touch_and_others_are_not(arm):
    beneath = touched_by_box(GRID, (-0.5, -0.5, -0.19), (0.5, 0.5, -0.11))
    space = space_of(beneath, np.zeros(GRID.shape, dtype=bool))
    stands = arm.standing_on(Stand.box(("base",), (-0.6, -0.6, -0.3), (0.6, 0.6, -0.1)))
    before, after = (link_distances(space, one, HOME, UP_TO_M) for one in (arm, stands))
    assert before.seen.link == "base" and before.seen.distance_m < 0.05
    assert after.links[0].link == "base" and not after.links[0].seen.is_there
    assert after.links[1:] == before.links[1:] and after.links[1].seen.is_there


def test_a_zone_to_keep_out_of_hides_nobody(arm):
    nothing = np.zeros(GRID.shape, dtype=bool)
    zone = Zone.box("door", "kept_out", (0.2, 0.2, 0.0), (0.6, 0.6, 1.0))
    inside = touched_by_box(GRID, (0.2, 0.2, 0.0), (0.6, 0.6, 1.0))
    kept_out = arm.with_zones(zone)
    free = link_distances(space_of(nothing, nothing), kept_out, HOME, UP_TO_M)
    assert free == link_distances(space_of(nothing, nothing), arm, HOME, UP_TO_M)
    for seen, unseen in ((inside, nothing), (nothing, inside)):
        space = space_of(seen, unseen)
        assert link_distances(space, kept_out, HOME, UP_TO_M) == link_distances(space, arm, HOME, UP_TO_M)


@pytest.mark.parametrize("up_to", (0.0, -1.0, float("nan"), float("inf")))
def test_a_distance_to_look_that_is_none_is_refused(arm, up_to):
    with pytest.raises(InputError, match="up_to_m"):
        link_distances(space_of(*[np.zeros(GRID.shape, dtype=bool)] * 2), arm, HOME, up_to)


@settings(max_examples=25)
@given(st.integers(0, 9999))
def test_no_point_moves_farther_than_the_greatest_stride(seed):
    arm, rng = C_ARM, np.random.default_rng(seed)
    rates = {name: float(rng.uniform(0, 1)) for name in arm.joint_names}
    joints = {joint.name: float(rng.uniform(0.9 * joint.lower, 0.9 * joint.upper)) for joint in arm.joints}
    step = 1e-4
    later = {name: value + step * rates[name] * rng.choice([-1, 1]) for name, value in joints.items()}
    strides = greatest_strides(arm, rates, 0.05)
    before, after = arm.world_from_links(joints), arm.world_from_links(later)
    for link in arm.links:
        if link.name not in strides:
            continue
        vertices = np.column_stack([link.vertices, np.ones(len(link.vertices))])
        moved = vertices @ (after[link.name] - before[link.name])[:3].T
        assert np.linalg.norm(moved, axis=1).max() <= strides[link.name] * step + 1e-9
    assert strides.keys() == set(arm.checked_links)
