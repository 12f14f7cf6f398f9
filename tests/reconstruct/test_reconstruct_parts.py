"""A voxel that no one camera sees all of, looked at again in parts: against a naive twin, and its laws."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import carve, reconstruct, resolve
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.parts import PARTS
from elbowroom.reconstruct.source import ImageSource
from elbowroom.reconstruct.terms import Terms
from reference import reconstruct_scenes as scenes
from reference.reconstruct_pixel import THROUGH, say_of_voxel
from reference.reconstruct_views import images_of, says_of
from reference.reconstruct_weaken import AGE, NOW, WAYS, some_margin, weakened


def a_room(seed):
    """A room of balls and boxes.

    Odd seeds have cameras whose pixels fly, and images with specks; every third has an explained patch, nearer than
    what was measured or farther.
    """
    rng = np.random.default_rng(seed)
    grid = VoxelGrid(tuple(rng.uniform(-0.5, 0.5, 3)), (9, 9, 9), 0.1)
    more = {"noise": NoiseModel(0.003, 0.0, 0.002)} if seed % 2 else {}
    cameras = scenes.random_cameras(rng, grid, 6, **more)
    scene = scenes.random_scene(rng, grid, cameras=cameras)
    frames = [scenes.DepthFrame(c.name, NOW, scenes.depth_of(c, scene)) for c in cameras]
    if seed % 2:
        frames = [with_specks(rng, frame) for frame in frames]
    model = {}
    if seed % 3 == 0:
        depth = frames[0].depth_m
        patch = np.indices(depth.shape)[1] > depth.shape[1] // 2
        model = {
            cameras[0].name: np.where(patch, depth * np.float32(rng.choice((0.9, 1.05))), 0).astype(
                np.float32
            )
        }
    return rng, grid, cameras, frames, scene, model


def with_specks(rng, frame):
    """The frame with single pixels that are near, or that have no return."""
    depth = frame.depth_m.copy()
    speck = rng.random(depth.shape) < 0.02
    depth[speck] = rng.choice((0.0, 0.1), speck.sum())
    return scenes.DepthFrame(frame.camera, NOW, depth)


def space_of(grid, cameras, frames, margin, model):
    evidence = carve(grid, cameras, frames, margin=margin, model_depth=model)
    space = resolve(evidence, cameras, margin=margin)
    images = room_images(cameras, frames)
    return replace(space, source=ImageSource(images, model, Terms(margin=margin), space.free_words))


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
        assert space.is_free_in_parts(tuple(index)) == expected


@pytest.mark.parametrize("seed", range(1, 60, 2))
def test_order_of_cameras_does_not_matter(seed):
    rng, grid, cameras, frames, _, model = a_room(seed)
    space = space_of(grid, cameras, frames, Margin(), model)
    order = rng.permutation(len(cameras))
    other = space_of(grid, [cameras[n] for n in order], frames, Margin(), model)
    for index in overridable(space):
        assert space.is_free_in_parts(tuple(index)) == other.is_free_in_parts(tuple(index))


@pytest.mark.parametrize("aside", [0.0, 0.9, 1.6])
def test_a_camera_close_by_sees_all_parts_that_are_in_its_image(aside):
    """Parts that look larger than what is cut out about them in spare pixels, ahead and far from the axis."""
    grid = VoxelGrid((-0.1, -0.1, 0.0), (1, 1, 1), 0.2)
    eye = np.array([aside * 0.2, 0.01, -0.1])
    camera = scenes.camera_at("c", eye, eye + (0, 0, 1), size=(961, 961), focal=80.0)
    frame = scenes.frame_of(camera, scenes.Scene())
    for own_px, lateral_px in ((None, 0.0), (None, 0.3), (None, 0.5), (12.0, 0.0)):
        own = None if own_px is None else Margin(lateral_px=own_px)
        space = space_of(grid, [replace(camera, margin=own)], [frame], Margin(lateral_px=lateral_px), {})
        assert space.free.all()
        assert space.is_free_in_parts((0, 0, 0))


def test_an_explained_pixel_is_free_up_to_the_model_in_parts_too():
    grid = VoxelGrid((1.0, -0.1, -0.1), (1, 1, 1), 0.2)
    camera = scenes.camera_at("c", (0, 0, 0), (1, 0, 0))
    depth = np.full((camera.height, camera.width), 1.1, dtype=np.float32)
    frame = scenes.DepthFrame("c", NOW, depth)
    for model_m, free in ((0.0, False), (1.15, False), (2.0, True)):
        model = {"c": np.full_like(depth, model_m)}
        space = space_of(grid, [camera], [frame], Margin(), model)
        assert space.free.all() == free
        assert space.is_free_in_parts((0, 0, 0)) == free


def test_a_voxel_that_anybody_disputes_is_not_free_in_parts():
    _, grid, cameras, frames, _, model = a_room(4)
    space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
    free = [tuple(i) for i in overridable(space) if space.is_free_in_parts(tuple(i))]
    for index in free:
        disputed = np.zeros(grid.shape, dtype=bool)
        disputed[index] = True
        other = replace(space, disputed_words=bits.pack(disputed, grid))
        assert [i for i in free if not other.is_free_in_parts(i)] == [index]


def test_what_no_camera_was_asked_of_is_not_free_in_parts():
    """Outside the focus of a carve nobody was asked whether he disputes."""
    _, grid, cameras, frames, _, _ = a_room(4)
    full = reconstruct(grid, cameras, frames, margin=Margin(lateral_px=0.0))
    nothing = reconstruct(
        grid,
        cameras,
        frames,
        margin=Margin(lateral_px=0.0),
        focus=np.zeros(full.free_words.shape, dtype=bool),
    )
    assert any(full.is_free_in_parts(tuple(index)) for index in overridable(full))
    assert not any(nothing.is_free_in_parts(tuple(index)) for index in overridable(nothing))


def test_some_voxels_are_free_in_parts_and_some_are_not():
    answers = []
    for seed in range(20):
        _, grid, cameras, frames, _, model = a_room(seed)
        space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
        answers += [space.is_free_in_parts(tuple(index)) for index in overridable(space)]
    assert 5 < sum(answers) < len(answers) - 5


def test_no_voxel_that_a_ball_touches_is_free_in_parts():
    """Nor one that a box touches: they are some pixels wide, and depth is exact."""
    asked = 0
    for seed in range(0, 60, 2):
        _, grid, cameras, frames, scene, _ = a_room(seed)
        space = space_of(grid, cameras, frames, Margin(), {})
        touched = scenes.touched(grid, scene)
        for index in overridable(space):
            if touched[tuple(index)]:
                asked += 1
                assert not space.is_free_in_parts(tuple(index))
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
        if weak.is_free_in_parts(tuple(index)):
            assert full.free[tuple(index)] or full.is_free_in_parts(tuple(index))


def test_without_its_frames_or_by_another_test_or_rule_nothing_is_free_in_parts():
    _, grid, cameras, frames, _, model = a_room(4)
    space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
    free = [tuple(i) for i in overridable(space) if space.is_free_in_parts(tuple(i))]
    assert free
    others = ({"detail": "footprint"}, {"rule": "majority"}, {"look_again": False})
    for other in others:
        terms = replace(space.source.terms, **other)
        assert not replace(space, source=replace(space.source, terms=terms)).is_free_in_parts(free[0])
    assert not space.released().is_free_in_parts(free[0])


def test_where_somebody_blocked_more_nothing_is_free_in_parts():
    _, grid, cameras, frames, _, model = a_room(4)
    space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
    free = [tuple(i) for i in overridable(space) if space.is_free_in_parts(tuple(i))]
    kept_out = np.zeros(grid.shape, dtype=bool)
    kept_out[:, :, :2] = True
    zone = replace(space, free_words=space.free_words & ~bits.pack(kept_out, grid))
    assert free and not any(zone.is_free_in_parts(index) for index in free)
    more = replace(space, free_words=space.free_words | bits.pack(kept_out, grid))
    assert any(more.is_free_in_parts(index) for index in free if not kept_out[index])
