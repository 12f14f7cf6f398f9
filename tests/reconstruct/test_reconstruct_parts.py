"""A voxel that no one camera sees all of, looked at again in parts: against a naive twin, and its laws."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import carve, reconstruct, resolve
from elbowroom.reconstruct.free_space import Source
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.parts import PARTS, is_free_in_parts
from reference import reconstruct_scenes as scenes
from reference.reconstruct_pixel import THROUGH, say_of_voxel
from reference.reconstruct_views import images_of, says_of
from reference.reconstruct_weaken import AGE, NOW, WAYS, some_margin, weakened


def a_room(seed):
    """A room of balls and boxes; odd seeds have noise and flying pixels, every third an explained patch."""
    rng = np.random.default_rng(seed)
    grid = VoxelGrid(tuple(rng.uniform(-0.5, 0.5, 3)), (9, 9, 9), 0.1)
    more = {"noise": NoiseModel(0.003, 0.0, 0.002)} if seed % 2 else {}
    cameras = scenes.random_cameras(rng, grid, 6, **more)
    scene = scenes.random_scene(rng, grid, cameras=cameras)
    frames = [scenes.DepthFrame(c.name, NOW, scenes.depth_of(c, scene)) for c in cameras]
    model = {}
    if seed % 3 == 0:
        depth = frames[0].depth_m
        patch = np.indices(depth.shape)[1] > depth.shape[1] // 2
        model = {cameras[0].name: np.where(patch, depth * np.float32(0.9), 0).astype(np.float32)}
    return rng, grid, cameras, frames, scene, model


def space_of(grid, cameras, frames, margin, model):
    evidence = carve(grid, cameras, frames, margin=margin, model_depth=model)
    source = Source(room_images(cameras, frames), margin, "pixel", "three", model)
    return resolve(evidence, cameras, margin=margin, source=source)


def overridable(space):
    """Voxels that are unseen and that nobody disputes."""
    said = space.surface_words | space.blind_words | space.disputed_words
    return np.argwhere(bits.unpack(space.blocked_words & ~said, space.grid))


def parts_of(grid, index):
    edge = grid.voxel_size_m
    return VoxelGrid(tuple(grid.lower_m + np.array(index) * edge), (PARTS,) * 3, edge / PARTS)


@pytest.mark.parametrize("seed", range(12))
def test_a_voxel_is_free_in_parts_as_its_parts_one_by_one_say(seed):
    rng, grid, cameras, frames, _, model = a_room(seed)
    margin = Margin(lateral_px=float(rng.choice((0, 0.5))), bias_m=float(rng.choice((0, 0.01))))
    space = space_of(grid, cameras, frames, margin, model)
    images = images_of(grid, cameras, frames, margin, model)
    voxels = overridable(space)
    for index in rng.permutation(voxels)[:12]:
        says = says_of(parts_of(grid, index), images, say_of_voxel)
        expected = (says & THROUGH).astype(bool).any(axis=0).all()
        assert is_free_in_parts(space, tuple(index)) == expected


def test_some_voxels_are_free_in_parts_and_some_are_not():
    answers = []
    for seed in range(20):
        _, grid, cameras, frames, _, model = a_room(seed)
        space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
        answers += [is_free_in_parts(space, tuple(index)) for index in overridable(space)]
    assert 5 < sum(answers) < len(answers) - 5


def test_no_voxel_that_a_ball_touches_is_free_in_parts():
    """Balls of three pixel pitches and more, exact depth."""
    asked = 0
    for seed in range(0, 60, 2):
        _, grid, cameras, frames, scene, _ = a_room(seed)
        space = space_of(grid, cameras, frames, Margin(), {})
        touched = scenes.touched(grid, scene)
        for index in overridable(space):
            if touched[tuple(index)]:
                asked += 1
                assert not is_free_in_parts(space, tuple(index))
    assert asked > 100


@pytest.mark.parametrize("seed", range(40))
def test_less_evidence_never_makes_a_voxel_free_in_parts(seed):
    rng, grid, cameras, frames, _, _ = a_room(seed)
    margin = some_margin(rng)
    fewer, wider = weakened(rng, frames, margin, {WAYS[seed % len(WAYS)]})
    same = {"now_ns": NOW, "max_age_ns": AGE}
    full = reconstruct(grid, cameras, frames, margin=margin, **same)
    weak = reconstruct(grid, cameras, fewer, margin=wider, **same)
    for index in overridable(weak):
        if is_free_in_parts(weak, tuple(index)):
            assert full.free[tuple(index)] or is_free_in_parts(full, tuple(index))


def test_without_its_frames_or_by_another_test_or_rule_nothing_is_free_in_parts():
    _, grid, cameras, frames, _, model = a_room(4)
    space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
    free = [tuple(i) for i in overridable(space) if is_free_in_parts(space, tuple(i))]
    assert free
    for source in (None, replace(space.source, detail="footprint"), replace(space.source, rule="majority")):
        assert not is_free_in_parts(replace(space, source=source), free[0])
