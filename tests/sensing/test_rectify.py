from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom import errors
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import distorted, usable_radius
from elbowroom.sensing import DepthFrame, rectified, rectify
from elbowroom.sensing.rectify import index_map_of
from reference import rectification as naive

BARREL = (-0.25, 0.06, 0.001, -0.0008, -0.005)
PINCUSHION = (0.12, -0.02, 0.0, 0.001, 0.0)
RATIONAL = (0.6, -2.7, 0.0006, -0.0002, 1.6, 0.48, -2.5, 1.5)
LENSES = [BARREL, PINCUSHION, RATIONAL]
WIDTH, HEIGHT = 80, 60


def camera_with(distortion, **more):
    return DepthCamera(
        name="north",
        width=WIDTH,
        height=HEIGHT,
        world_from_camera=np.eye(4),
        intrinsics=Intrinsics(fx=62.0, fy=60.0, cx=40.5, cy=29.0, distortion=distortion),
        **more,
    )


def frame_of(depth):
    return DepthFrame(camera="north", stamp_ns=None, depth_m=np.asarray(depth, dtype=np.float32))


@pytest.mark.parametrize("distortion", LENSES)
def test_forward_model_agrees_with_opencv(distortion):
    intrinsics = camera_with(distortion).intrinsics
    x, y = np.meshgrid(np.linspace(-0.6, 0.6, 13), np.linspace(-0.45, 0.45, 11))
    points = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 1, 3)
    matrix = np.array([[intrinsics.fx, 0, intrinsics.cx], [0, intrinsics.fy, intrinsics.cy], [0, 0, 1]])
    expected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(distortion))
    u, v = distorted(intrinsics, x, y)
    np.testing.assert_allclose(np.stack([u, v], axis=-1).reshape(-1, 2), expected[:, 0], atol=1e-9)


@pytest.mark.parametrize("distortion", [(), (0.0,) * 5, (0.0,) * 8])
def test_without_distortion_it_is_the_identity(distortion):
    depth = np.random.default_rng(1).uniform(0.5, 4.0, (HEIGHT, WIDTH)).astype(np.float32)
    depth[10:20, 30] = 0
    pinhole, least, greatest = rectify(camera_with(distortion), frame_of(depth))
    np.testing.assert_array_equal(least, depth)
    np.testing.assert_array_equal(greatest, depth)
    assert pinhole.intrinsics.distortion == ()


def test_the_twin_keeps_everything_but_the_distortion():
    camera = camera_with(BARREL, depth_kind="radial", min_depth_m=0.2, max_depth_m=5.0)
    twin = rectified(camera)
    assert not twin.intrinsics.is_distorted
    assert (twin.name, twin.width, twin.height, twin.depth_kind) == ("north", WIDTH, HEIGHT, "radial")
    assert (twin.intrinsics.fx, twin.intrinsics.cy) == (62.0, 29.0)
    assert (twin.min_depth_m, twin.max_depth_m) == (0.2, 5.0)


@pytest.mark.parametrize("distortion", LENSES)
def test_every_overlapping_raw_pixel_contributes(distortion):
    camera = camera_with(distortion)
    index_map = index_map_of(camera.intrinsics, WIDTH, HEIGHT)
    for v in (0, 7, 29, 44, HEIGHT - 1):
        for u in (0, 1, 13, 40, 66, WIDTH - 1):
            first_u, last_u, first_v, last_v = (int(edge[v, u]) for edge in index_map)
            if first_u < 0:
                continue
            needed = naive.contributors(camera.intrinsics, WIDTH, HEIGHT, u, v)
            rows, columns = zip(*needed, strict=True)
            assert first_u <= min(columns) and max(columns) <= last_u
            assert first_v <= min(rows) and max(rows) <= last_v


@pytest.mark.parametrize("distortion", LENSES)
def test_most_of_the_image_survives_and_contributors_are_few(distortion):
    index_map = index_map_of(camera_with(distortion).intrinsics, WIDTH, HEIGHT)
    kept = index_map.first_u >= 0
    assert kept.mean() > 0.6
    count = (index_map.last_u - index_map.first_u + 1) * (index_map.last_v - index_map.first_v + 1)
    assert count[kept].max() <= 16


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**32 - 1), lens=st.sampled_from(LENSES), kind=st.sampled_from(["planar", "radial"])
)
def test_never_farther_than_what_was_measured_nearby(seed, lens, kind):
    """Where a raw pixel measured something, the pinhole pixel that looks there is as near, or no return."""
    random = np.random.default_rng(seed)
    camera = camera_with(lens, depth_kind=kind)
    depth = random.uniform(0.5, 4.0, (HEIGHT, WIDTH)).astype(np.float32)
    depth[random.random((HEIGHT, WIDTH)) < 0.02] = 0
    pinhole, least, greatest = rectify(camera, frame_of(depth))
    assert pinhole.depth_kind == kind
    u, v = random.uniform(-0.5, WIDTH - 0.5, 500), random.uniform(-0.5, HEIGHT - 0.5, 500)
    x, y = (
        (u - camera.intrinsics.cx) / camera.intrinsics.fx,
        (v - camera.intrinsics.cy) / camera.intrinsics.fy,
    )
    raw_u, raw_v = distorted(camera.intrinsics, x, y)
    column, row = np.floor(raw_u + 0.5), np.floor(raw_v + 0.5)
    inside = (column >= 0) & (column < WIDTH) & (row >= 0) & (row < HEIGHT)
    at = np.floor(v + 0.5).astype(int), np.floor(u + 0.5).astype(int)
    assert (least[at][~inside] == 0).all()
    measured = depth[row[inside].astype(int), column[inside].astype(int)]
    assert (least[at][inside] <= measured).all()
    valid = least[at][inside] > 0
    assert (measured[valid] > 0).all()
    assert (greatest[at][inside][valid] >= measured[valid]).all()


@settings(max_examples=25)
@given(seed=st.integers(0, 2**32 - 1), lens=st.sampled_from(LENSES))
def test_a_pixel_made_invalid_only_takes_away(seed, lens):
    random = np.random.default_rng(seed)
    camera = camera_with(lens)
    depth = random.uniform(0.5, 4.0, (HEIGHT, WIDTH)).astype(np.float32)
    _, before, _ = rectify(camera, frame_of(depth))
    depth[random.integers(HEIGHT), random.integers(WIDTH)] = random.choice([0.0, np.nan, np.inf, -1.0])
    _, after, _ = rectify(camera, frame_of(depth))
    assert ((after == before) | (after == 0)).all()


def test_outside_the_range_of_depth_or_at_its_end_is_no_return():
    camera = camera_with(BARREL, min_depth_m=1.0, max_depth_m=3.0)
    for depth_m, expected in ((0.99, 0), (1.0, 1.0), (2.999, 2.999), (3.0, 0), (3.01, 0)):
        for distortion in (BARREL, ()):
            one = replace(camera, intrinsics=replace(camera.intrinsics, distortion=distortion))
            _, least, greatest = rectify(one, frame_of(np.full((HEIGHT, WIDTH), depth_m)))
            assert least[30, 40] == greatest[30, 40] == np.float32(expected)


@pytest.mark.parametrize("distortion", LENSES)
def test_kernel_equals_its_naive_twin(distortion):
    random = np.random.default_rng(3)
    depth = random.uniform(0.5, 4.0, (HEIGHT, WIDTH)).astype(np.float32)
    depth[random.random((HEIGHT, WIDTH)) < 0.1] = np.nan
    camera = camera_with(distortion, min_depth_m=0.7)
    _, least, greatest = rectify(camera, frame_of(depth))
    expected = naive.bounds(depth, index_map_of(camera.intrinsics, WIDTH, HEIGHT), 0.7, np.inf)
    np.testing.assert_array_equal(least, expected[0])
    np.testing.assert_array_equal(greatest, expected[1])


def test_where_the_model_folds_back_there_is_no_pixel():
    """A strong barrel polynomial turns round inside the image; beyond that it shows wrong directions."""
    intrinsics = Intrinsics(fx=30.0, fy=30.0, cx=39.5, cy=29.5, distortion=(-0.6, 0.0, 0.0, 0.0, 0.0))
    turn = 1 / np.sqrt(3 * 0.6)
    assert turn - 0.01 < usable_radius(intrinsics, 2.0) < turn
    index_map = index_map_of(intrinsics, WIDTH, HEIGHT)
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    radius = np.hypot(u - 39.5, v - 29.5) / 30.0
    assert (index_map.first_u[radius >= turn] == -1).all()
    assert (index_map.first_u[radius < 0.5] >= 0).all()


def test_frame_of_another_camera_or_size_is_refused():
    camera = camera_with(BARREL)
    with pytest.raises(errors.FrameError, match="frame of south: given for camera north"):
        rectify(camera, DepthFrame("south", None, np.zeros((HEIGHT, WIDTH), np.float32)))
    with pytest.raises(errors.FrameError, match=r"image is 60 x 80 pixels, its camera has 80 x 60"):
        rectify(camera, frame_of(np.zeros((WIDTH, HEIGHT))))
