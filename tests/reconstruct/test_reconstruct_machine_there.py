"""A machine that cameras see through is not where it is said to be; one that they see is."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, looking_at
from elbowroom.machine.elsewhere import elsewhere
from elbowroom.machine.rasterise import rasterise
from elbowroom.reconstruct import Terms, free_space_of
from elbowroom.reconstruct.machine_there import machine_there
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, Snapshot
from reference.contact_machines import joint, link, machine

WALL_M = 3.5
EYES = ((1.6, 0.4, 1.2), (-1.4, 0.9, 1.3), (0.2, -1.7, 1.4))
SIZES = {"foot": (0.2, 0.2, 0.3), "upper": (0.1, 0.8, 0.1), "fore": (0.1, 0.6, 0.1)}


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """A foot, an upper arm that turns on it, and a forearm that turns beside that."""
    return machine(
        tmp_path_factory.mktemp("arm"),
        link("foot", SIZES["foot"]),
        link("upper", SIZES["upper"], (0, 0.35, 0)),
        link("fore", SIZES["fore"], (0, 0.3, 0)),
        joint("turn", "foot", "upper", (0, 0, 0.25)),
        joint("bend", "upper", "fore", (0, 0.75, 0.12)),
    )


@pytest.fixture(scope="module")
def cameras():
    k = Intrinsics(90, 90, 63.5, 47.5)
    return [
        DepthCamera(
            f"c{n}", 128, 96, looking_at(eye, (0, 0.3, 0.2)), k, noise=NOISE_PRESETS["realsense_d435"]
        )
        for n, eye in enumerate(EYES)
    ]


def seen(machine_there, cameras, joints, said=None, before_m=None):
    """A moment of a machine that is somewhere, said to be at other joints or not; something may stand before it."""
    random, frames = np.random.default_rng(1), []
    for camera in cameras:
        drawn = rasterise(machine_there, camera, joints).astype(float)
        depth = np.where(np.isfinite(drawn), drawn, WALL_M)
        depth = depth + camera.noise.sigma(depth) * random.standard_normal(depth.shape)
        if before_m is not None:
            depth = np.minimum(depth, before_m)
        frames.append(DepthFrame(camera.name, 1, depth.astype(np.float32)))
    return Snapshot.taken(frames, said or joints, None, None)


@settings(max_examples=8)
@given(st.floats(-0.95, 0.95), st.floats(-0.95, 0.95), st.floats(-3, 3))
def test_a_machine_where_it_is_said_to_be_is_not_named(arm, cameras, turn, bend, about):
    base = np.eye(4)
    base[:2, :2] = ((np.cos(about), -np.sin(about)), (np.sin(about), np.cos(about)))
    stands = arm.at(base)
    assert machine_there(stands, cameras, seen(stands, cameras, {"turn": turn, "bend": bend})) == ()


@pytest.mark.parametrize("degrees", (90, 180, 270))
def test_a_base_that_is_turned_stops_and_the_turn_is_named(arm, cameras, degrees):
    angle, base = np.radians(degrees), np.eye(4)
    base[:2, :2] = ((np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle)))
    joints = {"turn": 0.2, "bend": 0.3}
    (found,) = machine_there(arm, cameras, seen(arm.at(base), cameras, joints))
    assert found.stops and found.kind == "machine"
    assert "fore" in found.about and f"turned by {degrees} degrees" in found.text
    assert "\n" not in found.text


def test_joints_that_are_others_name_the_links_behind_them(arm, cameras):
    snapshot = seen(arm, cameras, {"turn": 1.5, "bend": -0.9}, {"turn": -0.5, "bend": 0.9})
    (found,) = machine_there(arm, cameras, snapshot)
    assert "fore" in found.about and "foot" not in found.about and found.stops
    assert "the joints" in found.text


def test_one_link_that_is_not_there_is_a_warning(arm, cameras):
    (found,) = machine_there(
        arm, cameras, seen(arm, cameras, {"turn": 0.3, "bend": 0.9}, {"turn": 0.3, "bend": -0.9})
    )
    assert found.about == ("fore",) and not found.stops


def test_one_camera_alone_does_not_stop(arm, cameras):
    snapshot = seen(arm, cameras[:1], {"turn": 0.9, "bend": 0.0}, {"turn": -0.9, "bend": 0.0})
    assert not any(found.stops for found in machine_there(arm, cameras[:1], snapshot))


def test_what_stands_before_the_machine_says_only_that_it_is_not_seen(arm, cameras):
    joints = {"turn": 0.2, "bend": 0.3}
    (found,) = machine_there(arm, cameras, seen(arm, cameras, joints, before_m=0.4))
    assert not found.stops and "no camera sees anything" in found.text


def test_no_returns_say_nothing_and_no_joints_neither(arm, cameras):
    nothing = [DepthFrame(camera.name, 1, np.zeros((96, 128), np.float32)) for camera in cameras]
    joints = {"turn": 0.2, "bend": 0.3}
    found = elsewhere(arm, cameras, [frame.depth_m for frame in nothing], [joints] * 3)
    assert (found.through, found.agree, found.links, found.share) == (0, 0, (), 0.0)
    assert machine_there(arm, cameras, Snapshot.taken(nothing, None, None, None)) == ()


def test_pixels_that_see_through_are_those_that_a_plain_count_finds(arm, cameras):
    """The count by link, against one that draws each link alone."""
    is_at, said = {"turn": 0.9, "bend": 0.4}, {"turn": -0.2, "bend": 0.4}
    camera = replace(cameras[0], noise=None)
    depth = np.minimum(np.nan_to_num(rasterise(arm, camera, is_at), posinf=WALL_M), WALL_M)
    found = elsewhere(arm, [camera], [depth], [said])
    drawn = rasterise(arm, camera, said)
    through = agree = 0
    for row in range(1, 95):
        for column in range(1, 127):
            around = drawn[row - 1 : row + 2, column - 1 : column + 2]
            if np.isfinite(around).all():
                through += depth[row, column] > around.max() + 0.1
                agree += around.min() - 0.1 < depth[row, column] <= around.max() + 0.1
    assert (found.through, found.agree) == (through, agree) and through > 100 and agree > 100


def test_a_room_from_before_the_machine_names_the_key_that_says_so(arm, cameras):
    joints = {"turn": 0.2, "bend": 0.3}
    empty = [DepthFrame(camera.name, 1, np.full((96, 128), WALL_M, np.float32)) for camera in cameras]
    (found,) = machine_there(arm, cameras, Snapshot.taken(empty, joints, None, None))
    assert found.stops and "recording: {without_machine: true}" in found.text
    assert machine_there(arm, cameras, Snapshot.taken(empty, joints, None, None), is_absent=True) == ()


def test_a_machine_that_is_seen_though_it_is_declared_absent_is_a_warning(arm, cameras):
    joints = {"turn": 0.2, "bend": 0.3}
    (found,) = machine_there(arm, cameras, seen(arm, cameras, joints), is_absent=True)
    assert not found.stops and "leave recording.without_machine out" in found.text


def test_where_the_machine_never_stood_nothing_is_taken_for_it(arm, cameras):
    """Also what lies on its surface and within it: the space is that of the bare room."""
    snapshot = seen(arm, cameras, {"turn": 0.2, "bend": 0.3})
    grid = VoxelGrid.covering((-0.8, -0.8, 0.0), (0.8, 0.8, 1.0), 0.1)
    terms = Terms(without_machine=True)
    declared = free_space_of(grid, cameras, snapshot, arm, terms)
    bare = free_space_of(grid, cameras, snapshot, None, Terms())
    as_it_is = free_space_of(grid, cameras, snapshot, arm, Terms())
    assert np.array_equal(declared.free_words, bare.free_words) and not declared.body_words.any()
    assert as_it_is.body_words.any() and len(terms.allowances) == 1 and Terms().allowances == ()
