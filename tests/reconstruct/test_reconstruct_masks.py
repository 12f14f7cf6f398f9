"""Masked pixels say nothing: they free nothing, dispute nothing, and with a mask less evidence frees nothing either."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct import LAWFUL, Terms, carve, free_space_of
from elbowroom.sensing import DepthFrame, Snapshot, rectified
from reference import reconstruct_scenes as scenes
from reference.reconstruct_weaken import AGE, NOW, WAYS, some_margin, weakened

FEW = settings(derandomize=True, max_examples=12)
DETAILS = ("footprint", "pixel", "point")
rooms = st.integers(0, 10**6)


def masked_room(seed):
    """A random room whose cameras have masks: rectangles and single pixels."""
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    rng, grid, group, _, frames = scenes.random_room(seed, noise=noise, flying_pixels=seed % 3 != 0)
    return rng, grid, [masked(rng, camera) for camera in group], frames


def masked(rng, camera):
    mask = rng.random((camera.height, camera.width)) < 0.02
    v, u = rng.integers(0, camera.height), rng.integers(0, camera.width)
    mask[v : v + rng.integers(1, camera.height), u : u + rng.integers(1, camera.width)] = True
    return replace(camera, mask=mask)


def unmasked(camera):
    return replace(camera, mask=None)


def space_of(grid, cameras, frames, margin, rule="three", detail="pixel"):
    terms = Terms(rule, detail, margin, AGE)
    return free_space_of(grid, cameras, Snapshot(tuple(frames), now_ns=NOW), None, terms)


@pytest.mark.parametrize("detail", ["footprint", "pixel"])
@pytest.mark.parametrize("rule", LAWFUL)
@FEW
@given(seed=rooms, ways=st.sets(st.sampled_from(WAYS), min_size=1))
def test_with_a_mask_less_evidence_never_adds_free_space(detail, rule, seed, ways):
    rng, grid, cameras, frames = masked_room(seed)
    frames = [DepthFrame(frame.camera, NOW, frame.depth_m) for frame in frames]
    margin = some_margin(rng)
    fewer, wider = weakened(rng, frames, margin, ways)
    full = space_of(grid, cameras, frames, margin, rule, detail)
    weak = space_of(grid, cameras, fewer, wider, rule, detail)
    assert not (weak.free & ~full.free).any()


@pytest.mark.parametrize("detail", DETAILS)
@FEW
@given(seed=rooms)
def test_a_mask_adds_nothing_to_what_its_own_camera_sees_through_or_disputes(detail, seed):
    _, grid, cameras, frames = masked_room(seed)
    for camera, frame in zip(cameras, frames, strict=True):
        own = carve(grid, [camera], [frame], detail=detail, complete=True)
        plain = carve(grid, [unmasked(camera)], [frame], detail=detail, complete=True)
        assert not (own.through[0] & ~plain.through[0]).any()
        assert not (own.surface & ~plain.surface).any()
        if detail != "footprint":
            assert not (own.disputed & ~plain.disputed).any()


@pytest.mark.parametrize("detail", DETAILS)
@FEW
@given(seed=rooms)
def test_what_masked_pixels_deliver_changes_nothing(detail, seed):
    rng, grid, cameras, frames = masked_room(seed)
    for camera, frame in zip(cameras, frames, strict=True):
        still = replace(camera, flying_pixels=False)
        other = frame.depth_m.copy()
        other[camera.mask] = rng.choice(
            np.array((0, np.nan, 1.0, 50.0), np.float32), size=int(camera.mask.sum())
        )
        one = carve(grid, [still], [frame], detail=detail, complete=True)
        two = carve(
            grid, [still], [DepthFrame(frame.camera, frame.stamp_ns, other)], detail=detail, complete=True
        )
        np.testing.assert_array_equal(one.planes, two.planes)


def test_a_camera_with_all_masked_but_a_pixel_neither_frees_nor_disputes():
    grid = VoxelGrid((-0.8, -0.8, -0.8), (16, 16, 16), 0.1)
    mask = np.ones((36, 48), dtype=bool)
    mask[0, 0] = False
    camera = scenes.camera_at("one", (-3.0, 0.0, 0.0), (0.0, 0.0, 0.0), mask=mask)
    frame = scenes.frame_of(camera, scenes.Scene(walls=((-6, -6, -6), (0, 6, 6))))
    evidence = carve(grid, [camera], [frame], complete=True)
    plain = carve(grid, [unmasked(camera)], [frame], complete=True)
    assert plain.through[0].any() and plain.disputed.any()
    assert not evidence.through[0].any() and not evidence.disputed.any()


def test_a_camera_without_a_frame_disputes_what_its_mask_leaves_out_as_well():
    _, grid, cameras, _ = masked_room(4)
    lost = carve(grid, cameras[:1], [], complete=True)
    plain = carve(grid, [unmasked(cameras[0])], [], complete=True)
    np.testing.assert_array_equal(lost.planes, plain.planes)


def test_a_mask_that_masks_nothing_is_none():
    _, _, cameras, _ = masked_room(1)
    camera = cameras[0]
    assert replace(camera, mask=np.zeros_like(camera.mask)).mask is None


def test_dark_corners_no_longer_dispute_what_others_see_through():
    from reference.contradiction_room import MARGIN, room_cameras, room_scene

    grid = VoxelGrid((-1.9, -1.9, 0.0), (38, 38, 22), 0.1)
    dark = np.add.outer(np.abs(np.arange(120) - 59.5), np.abs(np.arange(160) - 79.5)) > 105
    cameras = room_cameras()
    exact = [scenes.frame_of(camera, room_scene()) for camera in cameras]
    frames = [DepthFrame(frame.camera, 0, np.where(dark, np.float32(0), frame.depth_m)) for frame in exact]
    snapshot, terms = Snapshot(tuple(frames)), Terms(margin=MARGIN)
    without = free_space_of(grid, cameras, snapshot, None, terms).free
    masks = [replace(camera, mask=dark) for camera in cameras]
    with_masks = free_space_of(grid, masks, snapshot, None, terms).free
    all_of_it = free_space_of(grid, cameras, Snapshot(tuple(exact)), None, terms).free
    assert not (without & ~with_masks).any()
    assert without.mean() < with_masks.mean() - 0.03
    assert not (with_masks & ~all_of_it).any()


def test_a_pinhole_pixel_is_masked_if_any_pixel_behind_it_is():
    lens = Intrinsics(60.0, 60.0, 39.5, 29.5, (0.1, -0.05, 0.001, 0.002, 0.0))
    mask = np.zeros((60, 80), dtype=bool)
    mask[20:30, 30:45] = True
    camera = DepthCamera("one", 80, 60, np.eye(4), lens, mask=mask)
    pinhole = rectified(camera).mask
    # what the image says where only masked pixels return nothing
    depth = np.where(mask, 0, 2.0).astype(np.float32)
    from elbowroom.sensing import rectify

    _, least, _ = rectify(camera, DepthFrame("one", 0, depth))
    _, whole, _ = rectify(camera, DepthFrame("one", 0, np.full_like(depth, 2.0)))
    np.testing.assert_array_equal(pinhole, (whole > 0) & (least == 0))
    assert pinhole.any() and pinhole.sum() < 400


@pytest.mark.parametrize("mask", [np.zeros((3, 3), bool), np.ones((60, 80)), np.zeros((80, 60), bool)])
def test_a_mask_of_another_size_or_kind_is_refused(mask):
    with pytest.raises(CameraError, match="mask is"):
        DepthCamera("one", 80, 60, np.eye(4), Intrinsics(60, 60, 39.5, 29.5), mask=mask)
