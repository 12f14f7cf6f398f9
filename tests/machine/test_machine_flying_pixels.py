"""Mixed pixels at the machine's edge, against hands: what stands alone is an edge, what has neighbours is a surface."""

import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.geometry.noise import NoiseModel
from elbowroom.machine import body_words, ceiling_c_arm, explain_frames
from elbowroom.machine.rasterise import rasterise

GRID = VoxelGrid((-2, -2, 0), (80, 80, 50), 0.05)
JOINTS = {"long": 0.0, "larm": 0.2, "propeller": 0.1, "carc": 0.0}
WALL_M = 4.5


@pytest.fixture(scope="module")
def scene():
    machine = ceiling_c_arm()
    world_from_camera = np.array([[-1.0, 0, 0, 0], [0, 0, -1, 1.9], [0, -1, 0, 1.2], [0, 0, 0, 1]])
    camera = DepthCamera(
        "one",
        160,
        120,
        world_from_camera,
        Intrinsics(90, 90, 79.5, 59.5),
        noise=NoiseModel(0.0015, 0.0, 0.00025),
    )
    drawn = rasterise(machine, camera, JOINTS)
    return machine, camera, drawn, np.where(np.isfinite(drawn), drawn, WALL_M).astype(np.float32)


def explained(scene, depth):
    machine, camera, _, _ = scene
    return explain_frames(machine, [camera], [depth], [JOINTS], grid=GRID)


def is_unexplained(model):
    """Neither fitting, nor a mixed pixel, nor a speck."""
    return (model <= 0) & (model > -1e-3)


def edge_pixels(drawn):
    """Pixels beside the machine that are not on the image's edge."""
    on = np.isfinite(drawn)
    about = np.zeros_like(on)
    for dv in (-1, 0, 1):
        for du in (-1, 0, 1):
            about |= np.roll(on, (dv, du), axis=(0, 1))
    beside = about & ~on
    beside[[0, -1]] = beside[:, [0, -1]] = False
    return np.argwhere(beside)


def test_a_lone_return_between_machine_and_wall_is_a_mixed_pixel(scene):
    _, camera, drawn, depth = scene
    for v, u in edge_pixels(drawn)[::37]:
        mixed = depth.copy()
        near = drawn[v - 1 : v + 2, u - 1 : u + 2].min()
        mixed[v, u] = (near + WALL_M) / 2
        assert np.isposinf(explained(scene, mixed).model_depth[camera.name][v, u])


def test_the_wall_beside_the_machine_is_not_the_machine(scene):
    _, camera, drawn, depth = scene
    straight = [
        (v, u) for v, u in edge_pixels(drawn) if np.isinf(drawn[v - 1 : v + 2, u - 1 : u + 2]).sum() >= 5
    ]
    model = explained(scene, depth).model_depth[camera.name]
    assert straight and all(model[v, u] <= 0 for v, u in straight)


@pytest.mark.parametrize("lost", [0.0, 0.3])
def test_a_hand_on_the_machine_stays_blocked(scene, lost):
    _, camera, drawn, depth = scene
    flat = [
        (v, u)
        for v, u in np.argwhere(np.isfinite(drawn[3:-3, 3:-3])) + 3
        if np.ptp(drawn[v - 2 : v + 3, u - 2 : u + 3]) < 0.02
    ]
    v, u = flat[len(flat) // 2]
    hand = depth.copy()
    hand[v - 2 : v + 3, u - 2 : u + 3] = drawn[v, u] - 0.08
    noise = np.random.default_rng(3)
    hand[noise.random(hand.shape) < lost] = 0
    hand[v, u] = drawn[v, u] - 0.08
    found = explained(scene, hand)
    assert is_unexplained(found.model_depth[camera.name])[v, u]
    point = camera.points_in_world(hand)[v, u]
    i, j, k = GRID.index_of(point)
    assert bits.unpack(found.unexplained_words, GRID)[i, j, k]


def test_a_lone_return_within_the_body_leaves_it_removed(scene):
    machine, _, drawn, depth = scene
    v, u = np.argwhere(np.isfinite(drawn))[200]
    lone = depth.copy()
    lone[v, u] = drawn[v, u] - 0.05
    assert not (explained(scene, lone).unexplained_words & body_words(machine, JOINTS, GRID)).any()


def test_losing_pixels_never_explains_a_return(scene):
    _, camera, _, depth = scene
    noise = np.random.default_rng(5)
    rough = depth + noise.normal(0, 0.01, depth.shape).astype(np.float32)
    rough[noise.random(depth.shape) < 0.1] = 2.2
    before = explained(scene, rough).model_depth[camera.name]
    fewer = np.where(noise.random(depth.shape) < 0.4, np.float32(0), rough)
    after = explained(scene, fewer).model_depth[camera.name]
    assert not (~is_unexplained(after) & is_unexplained(before)).any() and (after > 0).any()


@pytest.mark.parametrize("value", [0.0, np.nan, 1.0])
def test_one_or_two_pixels_amid_the_machine_are_the_machine(scene, value):
    _, camera, drawn, depth = scene
    inner = [
        (v, u)
        for v, u in np.argwhere(np.isfinite(drawn[3:-4, 3:-4])) + 3
        if np.isfinite(drawn[v - 2 : v + 4, u - 2 : u + 4]).all()
    ]
    for v, u in inner[:: len(inner) // 9]:
        for other in ((v, u), (v, u + 1), (v + 1, u + 1)):
            speck = depth.copy()
            speck[v, u] = speck[other] = value
            model = explained(scene, speck).model_depth[camera.name]
            np.testing.assert_allclose(model[v, u], -drawn[v, u], rtol=1e-5)
        three = depth.copy()
        three[v, u : u + 3] = value
        assert is_unexplained(explained(scene, three).model_depth[camera.name])[v, u + 1]
