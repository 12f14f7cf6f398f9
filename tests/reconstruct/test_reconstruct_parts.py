"""A voxel looked at again, in parts: against a naive twin, and its laws."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.machine import Explained
from elbowroom.reconstruct import reconstruct
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.growth import pixel_width_m
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.parts import FINE_PIXEL_M, LATERAL_PX, PARTS, finest_part_m, free_parts
from elbowroom.reconstruct.resolve import decide
from elbowroom.reconstruct.source import ImageSource
from elbowroom.reconstruct.terms import WITNESS_ANGLE_DEG, Terms
from elbowroom.reconstruct.witnesses import witnesses
from reference import reconstruct_scenes as scenes
from reference.reconstruct_pixel import DISPUTES, THROUGH, say_of_voxel
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


def space_of(grid, cameras, frames, margin, model, angle_deg=WITNESS_ANGLE_DEG, aged_m=None):
    terms = Terms(margin=margin, witness_angle_deg=angle_deg)
    images = room_images(cameras, frames, aged_m)
    kept = []
    evidence = carve_images(grid, images, Explained(model, None), terms, kept=kept)
    space = decide(evidence, cameras, None, None, terms)
    return replace(space, source=ImageSource(images, model, terms, space.free_words, kept=tuple(kept)))


def wide(margin):
    """The margin that parts are asked with."""
    return replace(margin, lateral_px=max(margin.lateral_px, LATERAL_PX))


def blocked(space):
    """Voxels that are not free, shape (n, 3)."""
    return np.argwhere(bits.unpack(space.blocked_words, space.grid))


def parts_free(space, index):
    """Which parts of a voxel are free, bool, shape (4, 4, 4)."""
    return unpacked(space.free_parts(tuple(index)))


def parts_free_as_seen(space, index):
    """The same, however wide pixels are."""
    return unpacked(free_parts(space.grid, tuple(index), space.source.kept))


def unpacked(word):
    """The bits of a word, bool, shape (4, 4, 4)."""
    return np.unpackbits(np.array([word]).view(np.uint8), bitorder="little").view(bool).reshape((PARTS,) * 3)


def whole(space):
    """Voxels of which all parts are free, though they are blocked."""
    return [tuple(index) for index in blocked(space) if parts_free(space, index).all()]


def parts_of(grid, index):
    edge = grid.voxel_size_m
    return VoxelGrid(tuple(grid.lower_m + np.array(index) * edge), (PARTS,) * 3, edge / PARTS)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("angle_deg", [0.0, 40.0])
def test_parts_are_free_as_smaller_voxels_are(seed, angle_deg):
    rng, grid, cameras, frames, _, model = a_room(seed)
    margin = Margin(lateral_px=float(rng.choice((0, 0.5))), bias_m=float(rng.choice((0, 0.01))))
    space = space_of(grid, cameras, frames, margin, model, angle_deg)
    images = images_of(grid, cameras, frames, wide(margin), model)
    alone = set(range(len(cameras))).difference(*witnesses(grid, tuple(cameras), angle_deg))
    groups = [*witnesses(grid, tuple(cameras), angle_deg), *((n,) for n in alone)]
    for index in rng.permutation(blocked(space))[:5]:
        says = says_of(parts_of(grid, index), images, say_of_voxel)
        through, disputes = (says & THROUGH).astype(bool), (says & DISPUTES).astype(bool).any(axis=0)
        seen = sum(through[list(group)].any(axis=0).astype(int) for group in groups)
        free = (seen >= 3) | ((seen >= 1) & ~disputes)
        found = free_parts(grid, tuple(index), space.source.kept)
        np.testing.assert_array_equal(unpacked(found), free)


@pytest.mark.parametrize("seed", range(1, 60, 2))
def test_order_of_cameras_does_not_matter(seed):
    rng, grid, cameras, frames, _, model = a_room(seed)
    space = space_of(grid, cameras, frames, Margin(), model)
    order = rng.permutation(len(cameras))
    other = space_of(grid, [cameras[n] for n in order], frames, Margin(), model)
    for index in blocked(space)[::5]:
        assert space.free_parts(tuple(index)) == other.free_parts(tuple(index))


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
        assert parts_free(space, (0, 0, 0)).all()


def test_an_explained_pixel_is_free_up_to_the_model_in_parts_too():
    grid = VoxelGrid((1.0, -0.1, -0.1), (1, 1, 1), 0.2)
    camera = scenes.camera_at("c", (0, 0, 0), (1, 0, 0))
    depth = np.full((camera.height, camera.width), 1.1, dtype=np.float32)
    frame = scenes.DepthFrame("c", NOW, depth)
    for model_m, free in ((0.0, False), (1.15, False), (2.0, True)):
        model = {"c": np.full_like(depth, model_m)}
        space = space_of(grid, [camera], [frame], Margin(), model)
        assert space.free.all() == free
        assert parts_free(space, (0, 0, 0)).all() == free


@pytest.mark.parametrize("seed", range(2))
def test_parts_are_no_finer_than_is_asked_for(seed):
    """Where quarters are too fine, parts are free by eights, as voxels of half the edge; where halves are, none is."""
    rng, grid, cameras, frames, _, model = a_room(seed)
    margin, edge = Margin(), grid.voxel_size_m
    space = space_of(grid, cameras, frames, margin, model)
    images, some = images_of(grid, cameras, frames, margin, model), 0
    for index in rng.permutation(blocked(space))[:12]:
        half = VoxelGrid(tuple(grid.lower_m + index * edge), (2, 2, 2), edge / 2)
        says = says_of(half, images, say_of_voxel)
        seen, disputes = ((says & what) > 0 for what in (THROUGH, DISPUTES))
        free = (seen.sum(axis=0) >= 3) | (seen.any(axis=0) & ~disputes.any(axis=0))
        found = [
            free_parts(grid, tuple(index), space.source.kept, finest) for finest in (0.3 * edge, 0.6 * edge)
        ]
        np.testing.assert_array_equal(unpacked(found[0]), free.repeat(2, 0).repeat(2, 1).repeat(2, 2))
        assert not found[1]
        some += free.any()
    assert some


def test_parts_are_no_finer_than_pixels():
    grid = VoxelGrid((1.0, -0.1, -0.1), (1, 1, 1), 0.2)
    eye, ahead, shares = (0, 0, 0), (1, 0, 0), []
    for focal in (40.0, 15.0, 8.0):
        camera = scenes.camera_at("c", eye, ahead, focal=focal)
        depth = np.full((camera.height, camera.width), 1.19, dtype=np.float32)
        space = space_of(grid, [camera], [scenes.DepthFrame("c", NOW, depth)], Margin(), {})
        shares.append(parts_free(space, (0, 0, 0)).mean())
    assert shares[0] > shares[1] > shares[2] == 0


def test_parts_beside_a_surface_are_free():
    """A voxel that a wall stands in is blocked, and so are the parts that the wall is in: those before it are free."""
    grid = VoxelGrid((1.0, -0.1, -0.1), (1, 1, 1), 0.2)
    camera = scenes.camera_at("c", (0, 0, 0), (1, 0, 0))
    depth = np.full((camera.height, camera.width), 1.17, dtype=np.float32)
    space = space_of(grid, [camera], [scenes.DepthFrame("c", NOW, depth)], Margin(), {})
    assert space.surface.all()
    np.testing.assert_array_equal(
        parts_free(space, (0, 0, 0)), np.broadcast_to((np.arange(4) < 3)[:, None, None], (4, 4, 4))
    )


def test_a_camera_without_a_frame_disputes_the_parts_that_it_looks_at():
    for seed in range(0, 8, 2):
        _, grid, cameras, frames, _, model = a_room(seed)
        margin = Margin(lateral_px=0.0)
        images = images_of(grid, cameras, frames[:-1], wide(margin), model)
        space = space_of(grid, cameras, frames[:-1], margin, model)
        for index in blocked(space)[::200]:
            says = says_of(parts_of(grid, index), images, say_of_voxel)
            seen, disputes = ((says & what) > 0 for what in (THROUGH, DISPUTES))
            free = (seen.sum(axis=0) >= 3) | (seen.any(axis=0) & ~disputes.any(axis=0))
            found = free_parts(grid, tuple(index), space.source.kept)
            np.testing.assert_array_equal(unpacked(found), free)


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
    assert any(full.free_parts(tuple(index)) for index in blocked(full)[::5])
    assert not any(nothing.free_parts(tuple(index)) for index in blocked(nothing)[::5])


def test_some_voxels_are_free_in_parts_and_some_are_not():
    shares = []
    for seed in range(0, 20, 3):
        _, grid, cameras, frames, _, model = a_room(seed)
        space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
        shares += [parts_free(space, index).mean() for index in blocked(space)[::4]]
    none, some, every = (
        np.mean(those) for those in np.array([[s == 0, 0 < s < 1, s == 1] for s in shares]).T
    )
    assert min(none, some, every) > 0.003


def test_no_part_that_a_ball_touches_is_free():
    """Nor one that a box touches: they are some pixels wide, and depth is exact."""
    asked = 0
    for seed in range(0, 60, 4):
        _, grid, cameras, frames, scene, _ = a_room(seed)
        space = space_of(grid, cameras, frames, Margin(), {})
        for index in blocked(space)[::7]:
            touched = scenes.touched(parts_of(grid, index), scene)
            asked += touched.any()
            assert not (parts_free(space, index) & touched).any()
    assert asked > 100


def test_where_pixels_are_fine_no_part_that_a_finger_touches_is_free():
    """Parts are finer than pixels there, and pixels wider: a finger two pixels thick is missed by none."""
    grid, rng = VoxelGrid((-0.05, -0.05, -0.05), (5, 5, 5), 0.02), np.random.default_rng(3)
    cut = asked = 0
    for _ in range(12):
        eyes = rng.normal(size=(6, 3))
        eyes *= 1.5 / np.linalg.norm(eyes, axis=1, keepdims=True)
        cameras = [scenes.camera_at(f"c{n}", eye, (0, 0, 0), focal=200.0) for n, eye in enumerate(eyes)]
        pixel_m = pixel_width_m(cameras, np.zeros(3))
        assert finest_part_m(pixel_m) < 0.005 < pixel_m < FINE_PIXEL_M
        corner, axis = rng.uniform(-0.03, 0.01, 3), rng.integers(3)
        size = np.where(np.arange(3) == axis, 0.06, rng.uniform(2.0, 2.6) * pixel_m)
        finger = scenes.Scene(boxes=np.concatenate([corner, corner + size])[None])
        frames = [scenes.frame_of(camera, finger) for camera in cameras]
        space = reconstruct(grid, cameras, frames, margin=Margin(lateral_px=0.0))
        assert not (space.free & scenes.touched(grid, finger)).any()
        for index in blocked(space):
            touched, free = scenes.touched(parts_of(grid, index), finger), parts_free(space, index)
            assert not (free & touched).any()
            asked += touched.any()
            cut += touched.any() and free.any()
    assert asked > 100 and cut > 30


def test_no_part_is_free_that_a_ball_may_have_come_to_since():
    """Each ball has moved by no more than anything may have since the images; older images leave fewer parts free."""
    asked = lost = 0
    for seed in range(0, 24, 4):
        rng, grid, cameras, frames, scene, _ = a_room(seed)
        far = 0.06
        newer, older = (
            space_of(grid, cameras, frames, Margin(), {}, aged_m={c.name: each for c in cameras})
            for each in (far / 2, far)
        )
        steps = rng.normal(size=(len(scene.balls), 3))
        steps *= far / np.linalg.norm(steps, axis=1, keepdims=True)
        balls = scene.balls + np.column_stack([steps, np.zeros(len(steps))])
        now = scenes.Scene(balls=balls, boxes=scene.boxes, walls=scene.walls)
        for index in blocked(older)[::9]:
            free = parts_free_as_seen(older, index)
            touched = scenes.touched(parts_of(grid, index), now)
            asked += touched.any() and not touched.all()
            assert not (free & touched).any()
            if not newer.free[tuple(index)]:
                before = parts_free_as_seen(newer, index)
                assert not (free & ~before).any()
                lost += (before & ~free).any()
    assert asked > 50 and lost > 10


@pytest.mark.parametrize("seed", range(40))
def test_less_evidence_never_makes_a_voxel_free_in_parts(seed):
    rng, grid, cameras, frames, _, _ = a_room(seed)
    margin = some_margin(rng)
    fewer, wider = weakened(rng, frames, margin, {WAYS[seed % len(WAYS)]})
    same = {"now_ns": NOW, "max_age_ns": AGE}
    full = reconstruct(grid, cameras, frames, margin=margin, **same)
    weak = reconstruct(grid, cameras, fewer, margin=wider, **same)
    for index in blocked(weak)[::9]:
        more = full.free[tuple(index)] or parts_free(full, index)
        assert not (parts_free(weak, index) & ~np.asarray(more)).any()


def test_without_its_frames_or_by_another_test_or_rule_nothing_is_free_in_parts():
    _, grid, cameras, frames, _, model = a_room(4)
    space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
    index = whole(space)[0]
    for other in ({"detail": "footprint"}, {"rule": "majority"}, {"look_again": False}):
        terms = replace(space.source.terms, **other)
        assert not replace(space, source=replace(space.source, terms=terms)).free_parts(index)
    assert not space.released().free_parts(index)


def test_where_somebody_blocked_more_nothing_is_free_in_parts():
    _, grid, cameras, frames, _, model = a_room(4)
    space = space_of(grid, cameras, frames, Margin(lateral_px=0.0), model)
    free = whole(space)
    kept_out = np.zeros(grid.shape, dtype=bool)
    kept_out[:, :, :2] = True
    zone = replace(space, free_words=space.free_words & ~bits.pack(kept_out, grid))
    assert free and not any(zone.free_parts(index) for index in free)
    more = replace(space, free_words=space.free_words | bits.pack(kept_out, grid))
    assert any(more.free_parts(index) for index in free if not kept_out[index])
