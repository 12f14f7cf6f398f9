"""Zones that a person declares: kept out, and not watched."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import MachineError
from elbowroom.geometry import bits
from elbowroom.machine import Zone
from elbowroom.machine.link import Surface
from elbowroom.machine.ways import never_out_of, reach_m
from elbowroom.machine.zone_words import zone_words
from elbowroom.motion import Cause, Level, Motion, check_motion
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)
SLIDE = Motion("slide", 1, 0.05)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def space_of(machine, *occupied, unseen=None):
    """A room in which some voxels are blocked, and some that nobody saw; the machine's own taken out."""
    mask = np.logical_or.reduce([nothing_in(GRID), *occupied])
    space = FreeSpace.from_occupied(GRID, mask)
    if unseen is not None:
        hidden = bits.pack(unseen & ~mask, GRID)
        space = replace(space, free_words=space.free_words & ~hidden)
    return space.without(machine, HOME)


def kept_out(lower, upper, name="door"):
    return Zone.box(name, "kept_out", lower, upper)


def high(links=("hand",), lower=(-1.5, -1.5, 0.5)):
    return Zone.box("high", "not_watched", lower, (1.5, 1.5, 1.2), links, "above the cameras")


def test_a_zone_kept_out_blocks_though_all_is_seen_to_be_free(arm):
    guarded = arm.with_zones(kept_out((0.81, -1, 0.3), (0.99, 1, 0.8)))
    found = check_motion(space_of(arm), guarded, HOME, SLIDE)
    assert (found.cause, found.zone, found.link, found.overridable) == (
        Cause.KEPT_OUT,
        "door",
        "hand",
        False,
    )
    assert 0.0 < found.free_travel <= 0.81 - 0.69 and found.row()["zone"] == "door"
    assert check_motion(space_of(arm), arm, HOME, SLIDE).level is Level.CLEAR
    # what is seen there is said to be that
    seen = check_motion(
        space_of(arm, touched_by_box(GRID, (0.8, -1, 0.3), (1, 1, 0.8))), guarded, HOME, SLIDE
    )
    assert (seen.cause, seen.zone) == (Cause.SURFACE, None)


def test_a_link_that_stands_in_a_zone_kept_out_goes_nowhere(arm):
    guarded = arm.with_zones(kept_out((0.4, -0.2, 0.4), (0.9, 0.2, 0.7)))
    for way in (1, -1):
        found = check_motion(space_of(arm), guarded, HOME, Motion("slide", way, 0.05))
        assert (found.level, found.free_travel, found.cause) == (Level.STOP, 0.0, Cause.KEPT_OUT)


def test_what_nobody_saw_is_free_in_a_zone_not_watched_for_its_links_alone(arm):
    unseen = touched_by_box(GRID, (0.75, -1, 0.605), (1.2, 1, 1.2))
    space = space_of(arm, unseen=unseen)
    assert check_motion(space, arm, HOME, SLIDE).cause is Cause.UNSEEN
    assert check_motion(space, arm.with_zones(high()), HOME, SLIDE).level is Level.CLEAR
    assert check_motion(space, arm.with_zones(high(("cart",))), HOME, SLIDE).cause is Cause.UNSEEN
    # and no voxel becomes free by it
    before = space.free.copy()
    check_motion(space, arm.with_zones(high(("*",))), HOME, SLIDE)
    assert (space.free == before).all()


@pytest.mark.parametrize("plane", ["surface_words", "blind_words", "disputed_words"])
def test_what_any_camera_disputes_blocks_in_a_zone_not_watched(arm, plane):
    unseen = touched_by_box(GRID, (0.75, -1, 0.605), (1.2, 1, 1.2))
    space = space_of(arm, unseen=unseen)
    space = replace(space, **{plane: getattr(space, plane) | bits.pack(unseen, GRID)})
    found = check_motion(space, arm.with_zones(high()), HOME, SLIDE)
    assert found.level is not Level.CLEAR and found.free_travel < 0.11


def test_what_cameras_were_not_asked_of_stays_blocked_in_a_zone_not_watched(arm):
    unseen = touched_by_box(GRID, (0.75, -1, 0.605), (1.2, 1, 1.2))
    space = space_of(arm, unseen=unseen)
    unasked = replace(space, looked_at=np.zeros(space.free_words.size, dtype=np.bool_))
    assert check_motion(unasked, arm.with_zones(high()), HOME, SLIDE).cause is Cause.UNSEEN


corner = st.tuples(st.floats(-1.4, 1.2), st.floats(-1.4, 1.2), st.floats(-0.3, 1.0))
size = st.tuples(*[st.floats(0.02, 0.8)] * 3)
boxes = st.lists(st.tuples(corner, size), min_size=1, max_size=3)


@settings(max_examples=30)
@given(boxes, st.sampled_from(["slide", "turn", "nod"]), st.sampled_from([1, -1]), st.integers(0, 99))
def test_more_zones_kept_out_are_never_milder(arm, zones, joint, way, seed):
    lower = np.random.default_rng(seed).uniform(-1, 0.8, 3)
    space = space_of(arm, touched_by_box(GRID, lower, lower + 0.3))
    made = [kept_out(at, np.add(at, by), str(n)) for n, (at, by) in enumerate(zones)]
    motion, before = Motion(joint, way, 0.1), None
    for count in range(len(made) + 1):
        found = check_motion(space, arm.with_zones(*made[:count]), HOME, motion)
        assert before is None or found.free_travel <= before.free_travel
        assert before is None or found.level.rank <= before.level.rank
        assert (
            before is None
            or before.overridable
            or not found.overridable
            or found.free_travel < before.free_travel
        )
        before = found


@settings(max_examples=30)
@given(corner, size, st.sampled_from(["slide", "turn"]), st.integers(0, 99))
def test_a_zone_not_watched_frees_what_is_neither_seen_nor_disputed(arm, at, by, joint, seed):
    """Free travel in it is never more than in a space in which all is free that lies in it and that nobody disputes."""
    rng = np.random.default_rng(seed)
    lower = rng.uniform(-1, 0.6, 3)
    hidden = touched_by_box(GRID, lower, lower + 0.6)
    thing = touched_by_box(GRID, lower + 0.2, lower + 0.3)
    zone = Zone.box("z", "not_watched", at, np.add(at, by), ("*",), "test")
    space = space_of(arm, thing, unseen=hidden)
    motion = Motion(joint, 1, 0.1)
    found = check_motion(space, arm.with_zones(zone), HOME, motion)
    within = hidden & ~thing & touched_by_box(GRID, at, np.add(at, by))
    freer = replace(space, free_words=space.free_words | bits.pack(within, GRID))
    assert check_motion(space, arm, HOME, motion).free_travel <= found.free_travel
    assert found.free_travel <= check_motion(freer, arm, HOME, motion).free_travel


def naive(zone, grid, wholly):
    """By the corners of each voxel: inside all half-spaces; or beyond none of them with all."""
    cut = np.array(np.meshgrid(*[[0, 1]] * 3)).reshape(3, -1).T
    corners = (
        grid.lower_m + (np.moveaxis(np.indices(grid.shape), 0, -1)[..., None, :] + cut) * grid.voxel_size_m
    )
    out = corners @ zone.planes[:, :3].T + zone.planes[:, 3]
    return (out <= 1e-6).all(axis=(-1, -2)) if wholly else (out.min(axis=-2) <= 1e-6).all(axis=-1)


@settings(max_examples=15)
@given(corner, size, st.booleans())
def test_voxels_of_a_zone_are_those_whose_corners_say_so(at, by, turned):
    grid = room(0.15)
    box = trimesh.creation.box(by)
    if turned:
        box.apply_transform(trimesh.transformations.rotation_matrix(0.6, (1, 2, 3)))
    box.apply_translation(at)
    zone = Zone.mesh("z", "kept_out", Surface(box.vertices, box.faces))
    wholly, touched = (bits.unpack(zone_words(zone, grid, which), grid) for which in (True, False))
    assert (wholly == naive(zone, grid, True)).all()
    assert not (touched & ~naive(zone, grid, False)).any()
    # none is left out that holds a point of the zone
    points = trimesh.sample.volume_mesh(box, 200) if box.is_watertight else np.zeros((0, 3))
    inside = [tuple(grid.index_of(point)) for point in points if grid.contains(point)]
    assert all(touched[index] for index in inside)


def test_zones_say_what_is_wrong_with_them(arm):
    two = trimesh.util.concatenate([trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1))])
    two.vertices[8:] += 3
    flat = Surface(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2]]))
    for make, words in (
        (lambda: kept_out((0, 0, 1), (1, 1, 0)), "has no inside"),
        (lambda: kept_out((0, 0, np.nan), (1, 1, 0)), "three finite numbers"),
        (lambda: kept_out((0, 0, 0), (1, 1, 1), ""), "give it a name"),
        (lambda: Zone.box("a", "kept_out", (0, 0, 0), (1, 1, 1), ("hand",)), "leave out links"),
        (lambda: Zone.box("a", "not_watched", (0, 0, 0), (1, 1, 1), (), "why"), "name them"),
        (lambda: Zone.box("a", "not_watched", (0, 0, 0), (1, 1, 1), ("hand",)), "give one"),
        (lambda: Zone.mesh("a", "kept_out", Surface(two.vertices, two.faces)), "not convex"),
        (lambda: Zone.mesh("a", "kept_out", flat), "no inside"),
        (lambda: arm.with_zones(high(("nobody",))), "link 'nobody' does not exist"),
        (lambda: arm.with_zones(high(), high()), "more than once"),
    ):
        with pytest.raises(MachineError, match=words):
            make()


def test_zones_stand_in_what_is_said_of_a_machine(arm):
    said = arm.with_zones(high(), kept_out((0, 0, 0), (1, 1, 1))).allowances
    assert said == (
        "Not watched for hand, by the site's word: high, (-1.5, -1.5, 0.5) to (1.5, 1.5, 1.2) m (above the cameras)",
        "Kept out of, by the site's word: door, (0, 0, 0) to (1, 1, 1) m",
    )


def test_links_that_never_leave_a_volume_are_found(arm):
    all_of_it = Zone.box("all", "not_watched", (-3, -3, -3), (3, 3, 3), ("*",), "why")
    assert never_out_of(arm, [(all_of_it.has, lambda _: True)]) == ("cart", "arm", "hand")
    assert never_out_of(arm, [(all_of_it.has, all_of_it.names)]) == ("cart", "arm", "hand")
    # the hand is always above 0.5 m, and the arm is not
    assert never_out_of(arm, [(high().has, lambda _: True)]) == ("hand",)
    assert 1.2 < reach_m(arm) < 3.0
