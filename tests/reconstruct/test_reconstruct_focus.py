from dataclasses import replace

import numpy as np
import pytest

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.machine import Explained
from elbowroom.reconstruct import Terms, layout, reconstruct
from elbowroom.reconstruct.carve import carve_images
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.parts import free_parts
from elbowroom.reconstruct.regions import regions
from elbowroom.sensing import DepthFrame
from reference import reconstruct_scenes as scenes

GRID = VoxelGrid((-0.8, -0.6, 0.5), (32, 24, 20), 0.05)
CAMERA = DepthCamera("one", 64, 48, np.eye(4), Intrinsics(40, 40, 31.5, 23.5))


def a_frame():
    depth = np.full((48, 64), 1.4, dtype=np.float32)
    depth[20:30, 25:40] = 0.9
    return DepthFrame("one", 0, depth)


@pytest.mark.parametrize("detail", ["footprint", "pixel", "point"])
def test_in_focus_all_is_as_ever_and_out_of_focus_nothing_is_free(detail):
    focus = np.zeros(bits.word_count(GRID), dtype=bool)
    focus[::2] = True
    everywhere = reconstruct(GRID, [CAMERA], [a_frame()], detail=detail)
    focused = reconstruct(GRID, [CAMERA], [a_frame()], detail=detail, focus=focus)
    for name in ("free_words", "surface_words", "blind_words", "disputed_words"):
        assert (getattr(focused, name)[focus] == getattr(everywhere, name)[focus]).all()
    assert not focused.free_words[~focus].any() and focused.free_words.any()
    assert everywhere.free_words[~focus].any()


def a_room(seed):
    """A random room: frames with holes, one may be missing; a machine, a mask, ages; terms."""
    rng = np.random.default_rng(seed)
    grid = scenes.random_grid(rng)
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 3 else None
    cameras = scenes.random_cameras(rng, grid, 4, noise=noise)
    scene = scenes.random_scene(rng, grid, cameras=cameras)
    depths = [scenes.depth_of(camera, scene) for camera in cameras]
    model = {}
    for camera, depth in zip(cameras, depths, strict=True):
        depth[rng.random(depth.shape) < 0.03] = rng.choice((0, np.nan, np.inf, -1))
        model[camera.name] = np.zeros_like(depth)
        model[camera.name][4:16, 10:30] = np.nan_to_num(depth[4:16, 10:30], nan=0, posinf=0).clip(0)
    mask = rng.random(depths[0].shape) < 0.1
    cameras = [replace(cameras[0], mask=mask), *cameras[1:]]
    frames = [DepthFrame(camera.name, 0, depth) for camera, depth in zip(cameras, depths, strict=True)]
    aged = {camera.name: float(rng.choice((0.0, 0.01, 0.05))) for camera in cameras} if seed % 2 else {}
    images = room_images(cameras, frames[: len(frames) - (seed % 4 == 3)], aged)
    terms = Terms(margin=Margin(lateral_px=float(rng.choice((0, 0.5, 1.2)))), witness_angle_deg=0)
    return rng, grid, images, Explained(model if seed % 5 else {}, None), terms


@pytest.fixture
def rubbish(monkeypatch):
    """Buffers that hold what nobody expects wherever it is not written."""
    fresh = layout.Layout.take_buffers

    def take(self, split):
        buffers, rng = fresh(self, split), np.random.default_rng(0)
        for array in (*buffers.texels, buffers.windows):
            array[:] = rng.integers(0, 2**32, array.shape, dtype=np.uint32)
        return buffers

    monkeypatch.setattr(layout.Layout, "take_buffers", take)


@pytest.mark.parametrize("seed", range(16))
def test_pixels_that_no_voxel_in_focus_asks_have_no_say(rubbish, seed):
    rng, grid, images, explained, terms = a_room(seed)
    words = bits.word_count(grid)
    everywhere, kept_all = None, []
    for complete in (False, True):
        everywhere = carve_images(grid, images, explained, terms, complete=complete, kept=kept_all)
        for share in (0.0, 0.02, 0.3):
            focus, kept = rng.random(words) < share, []
            focus[rng.integers(words)] = True
            focused = carve_images(grid, images, explained, terms, complete=complete, focus=focus, kept=kept)
            np.testing.assert_array_equal(focused.planes[:, focus], everywhere.planes[:, focus])
            assert not focused.planes[:, ~focus].any()
    voxels = np.argwhere(bits.unpack(np.where(focus, bits.inside(grid), np.uint64(0)), grid))
    for voxel in voxels[rng.permutation(len(voxels))[:40]]:
        index = tuple(int(n) for n in voxel)
        assert free_parts(grid, index, kept[-1:]) == free_parts(grid, index, kept_all[-1:])


def test_a_small_focus_asks_a_small_part_of_an_image_and_one_behind_the_camera_none():
    plan = layout.layout_of(GRID, (CAMERA,), Margin())
    asked = bits.empty(GRID)
    asked[0] = np.uint64(1)
    cubes = np.array([0])
    (top, bottom, left, right), *none = regions(plan, asked, cubes, {})
    assert not none
    assert 0 < (bottom - top) * (right - left) < 48 * 64
    assert regions(plan, bits.empty(GRID), cubes[:0], {}) == [(0, 0, 0, 0)]
    turned = np.diag((-1.0, 1.0, -1.0, 1.0))
    away = layout.layout_of(GRID, (replace(CAMERA, world_from_camera=turned),), Margin())
    assert regions(away, asked, cubes, {}) == [(0, 0, 0, 0)]
    # nearer than anything may have moved: it may be anywhere
    assert regions(plan, asked, cubes, {"one": 1.0}) == [(0, 48, 0, 64)]
