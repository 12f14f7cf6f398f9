"""Eight pixels and 64 voxels at once, against one at a time."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from elbowroom.geometry import bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.reconstruct.images import room_images
from elbowroom.reconstruct.kernels.cone import VOXEL
from elbowroom.reconstruct.kernels.outline import MOST_PIXELS, OUTLINES, settle_block
from elbowroom.reconstruct.kernels.pixel import settle_word
from elbowroom.reconstruct.kernels.place import cube_at, voxels_of
from elbowroom.reconstruct.kernels.rows import short_of, shorts_of, tellings_of
from elbowroom.reconstruct.layout import layout_of
from elbowroom.reconstruct.views import fill
from elbowroom.sensing import DepthFrame
from reference import reconstruct_scenes as scenes

texel = st.one_of(st.integers(0, 0xFFFFFFFF), st.sampled_from((0, 0xFFFF, 0xFFFF0000, 0xFFFFFFFF)))
depth = st.integers(0, 65535)


@njit
def marks_of(texels, places, clear_from, hidden_to):
    """All marks from compiled code."""
    at, stride, last = places
    return (
        short_of(texels, at, clear_from),
        shorts_of(texels, at, stride, last, clear_from),
        tellings_of(texels, at, stride, last, (clear_from, hidden_to)),
    )


@given(
    st.lists(texel, min_size=80, max_size=80),
    st.integers(0, 2),
    st.integers(8, 10),
    st.integers(0, 7),
    depth,
    depth,
)
@settings(max_examples=200)
def test_marks_of_eight_rows_of_eight_texels_are_those_of_each(
    texels, at, stride, last, clear_from, hidden_to
):
    short = tell = 0
    for row, n in product(range(8), range(8)):
        one = texels[at + min(row, last) * stride + n]
        least, greatest = one >> 16, 65535 - (one & 0xFFFF)
        short |= (least < clear_from) << (8 * row + n)
        tell |= (not (least >= clear_from or greatest <= hidden_to)) << (8 * row + n)
    given_texels, limits = np.array(texels, dtype=np.uint32), (np.uint32(clear_from), np.uint32(hidden_to))
    due = short & 0xFF, short, tell
    assert tuple(map(int, marks_of(given_texels, (at, stride, last), *limits))) == due
    # as they stand, without the compiler
    assert int(short_of(given_texels, at, limits[0])) == due[0]
    assert int(shorts_of(given_texels, at, stride, last, limits[0])) == due[1]
    assert int(tellings_of(given_texels, at, stride, last, limits)) == due[2]


def compare(views, lattice, rng):
    """Blocks of all cubes and cameras: how many differ, how many were asked, and how many have voxels seen through."""
    different, asked, seen, wide = 0, 0, 0, 0
    every, none = np.uint64(0xFFFFFFFFFFFFFFFF), np.uint64(0)
    voxel, outlines = np.zeros(1, VOXEL)[0], np.zeros(1, OUTLINES)[0]
    cubes = lattice.cubes_x * lattice.cubes_y * lattice.cubes_z
    for number, camera, lane in product(range(cubes), views.cameras, range(0, 64, 3)):
        boxes = voxels_of(cube_at(lattice, number), lane)
        plain = settle_word(camera, views.texels, every, boxes, voxel)
        stopped = every & ~np.uint64(plain[0])
        # of some voxels it is only asked whether they are seen through, and of others nothing is told by it
        surface = rng.integers(0, 2**64, dtype=np.uint64)
        fast = settle_block(camera, views.texels, (every, surface), False, boxes, (outlines, voxel))
        known = settle_block(camera, views.texels, (stopped, none), True, boxes, (outlines, voxel))
        different += plain[0] != fast[0]
        different += any((int(a) ^ int(b)) & ~int(surface) for a, b in zip(plain, fast, strict=True))
        different += tuple(int(word) & int(stopped) for word in plain) != tuple(map(int, known))
        asked += 1
        seen += plain[0] != 0
        wide += ((outlines.right - outlines.left >= 8) & (outlines.right - outlines.left < MOST_PIXELS)).any()
    return different, asked, seen, wide


@pytest.mark.parametrize("seed", range(6))
def test_a_block_at_once_is_its_voxels_one_by_one(seed):
    rng = np.random.default_rng(seed)
    noise = NoiseModel(0.003, 0.0, 0.002) if seed % 2 else None
    grid = scenes.random_grid(rng)
    cameras = scenes.random_cameras(rng, grid, 4, noise=noise)
    scene = scenes.random_scene(rng, grid, cameras=cameras)
    frames, model = [], {}
    for camera in cameras:
        image = scenes.depth_of(camera, scene)
        image *= 1.0 + 0.01 * rng.standard_normal(image.shape).astype(np.float32) * (seed % 3)
        image[rng.random(image.shape) < 0.03] = rng.choice((0, np.nan, np.inf, -1))
        patch = np.zeros_like(image)
        patch[5:20, 8:30] = np.nan_to_num(image[5:20, 8:30], nan=0, posinf=0).clip(0)
        model[camera.name] = patch
        frames.append(DepthFrame(camera.name, 0, image))
    margin = Margin(lateral_px=float(rng.choice((0, 0.5, 1.2))), bias_m=float(rng.choice((0, 0.01))))
    images = room_images(cameras, frames)
    layout = layout_of(grid, images.cameras, margin)
    views, buffers = fill(layout, images, model)
    different, asked, seen, wide = compare(views, bits.lattice(grid), rng)
    layout.give_back(buffers)
    assert different == 0
    assert asked > 50
    assert seen > 0
    assert wide > 0
