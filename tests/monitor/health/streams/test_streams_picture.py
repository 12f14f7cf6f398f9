"""What an image is beside the last good one of its camera."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.monitor.health.streams.camera_stream import CameraStream
from elbowroom.monitor.health.streams.cause import HealthCause
from elbowroom.monitor.health.streams.cover import Cover
from elbowroom.monitor.health.streams.picture import agrees, equal_share, oddity, pairs_of
from elbowroom.monitor.health.streams.thumb import Thumb
from reference.small_streams import Sensor, a_camera, walls

CAMERA = a_camera()
SENSOR = Sensor(CAMERA)
STRETCH = CameraStream(CAMERA)._stretch


def odd(image, old=None, others=None):
    new, before = Thumb.of(np.float32(image)), Thumb.of(SENSOR.image() if old is None else np.float32(old))
    assert not agrees(new, before)
    found = oddity(new, before, pairs_of(new, before, STRETCH), others or {})
    return None if found is None else found.cause


@given(st.floats(0.001, 0.8) | st.floats(1.25, 60.0))
def test_one_factor_is_a_wrong_scale(factor):
    assert odd(SENSOR.image() * factor) is HealthCause.CAMERA_WRONG_SCALE


@given(st.floats(0.3, 5.0))
def test_one_length_more_is_a_wrong_scale_too(off_m):
    assert odd(SENSOR.image() + off_m) is HealthCause.CAMERA_WRONG_SCALE


def test_disparity_distance_and_swapped_bytes_are_a_wrong_encoding():
    depth = SENSOR.image()
    radial = depth * STRETCH
    raw = (1000 * depth).astype(np.uint16)
    for image in (0.1 / depth, raw.byteswap() / 1000, SENSOR.random.random(depth.shape) * 5 + 0.1):
        assert odd(image) is HealthCause.CAMERA_WRONG_ENCODING
    if not agrees(Thumb.of(radial), Thumb.of(depth)):
        assert odd(radial) is HealthCause.CAMERA_WRONG_ENCODING


def test_an_image_of_another_camera_is_swapped():
    other = Sensor(CAMERA, seed=5)
    other.room_m = walls(CAMERA)[::-1, ::-1].copy()[:, ::-1] * np.linspace(0.6, 2.2, CAMERA.width)
    others = {"c1": Thumb.of(other.image())}
    assert odd(other.image(), others=others) is HealthCause.CAMERA_SWAPPED
    assert odd(SENSOR.image() * 4, others=others) is HealthCause.CAMERA_WRONG_SCALE


def test_bytes_of_a_flat_wall_are_found_swapped_though_neighbours_stay_alike():
    # of a wall at one distance the swapped bytes make another wall, a little rougher
    wall = np.float32(3.9 + SENSOR.random.normal(size=(48, 64)) * 0.002)
    swapped = (1000 * wall).astype(np.uint16).byteswap() / 1000
    assert odd(swapped, old=wall) is HealthCause.CAMERA_WRONG_ENCODING


@pytest.mark.parametrize(
    ("rows", "columns", "how"),
    [(-1, -1, "turned by 180 degrees"), (1, -1, "mirrored"), (-1, 1, "upside down")],
)
def test_a_picture_that_is_turned_about_in_its_frame_is_a_wrong_encoding(rows, columns, how):
    slope = 1 + np.linspace(0, 2, 64)[None, :] + np.linspace(0, 1, 48)[:, None]
    old, new = (Thumb.of(np.float32(image)) for image in (slope, slope[::rows, ::columns]))
    found = oddity(new, old, pairs_of(new, old, STRETCH), {})
    assert found is not None and found.cause is HealthCause.CAMERA_WRONG_ENCODING and found.text.endswith(how)


def test_the_camera_that_is_named_is_the_one_whose_image_fits_best():
    mine, close = SENSOR.image(), SENSOR.image() * np.linspace(1.3, 2.6, 64, dtype=np.float32)
    alike = np.float32(close * np.where(np.arange(64) % 3, 1, 1.1))
    others = {"c1": Thumb.of(alike), "c2": Thumb.of(close), "c3": Thumb.of(mine)}
    new, old = Thumb.of(close + np.float32(0.001)), Thumb.of(mine)
    found = oddity(new, old, pairs_of(new, old, STRETCH), others)
    assert found is not None and found.cause is HealthCause.CAMERA_SWAPPED and "camera c2" in found.text


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_an_image_is_anothers_only_where_it_agrees_with_that_one_twice_as_well_as_with_its_own(
    own, others_share
):
    """Columns that agree with neither, with its own, with the other, or with both."""
    column = np.arange(64) / 64
    old, other = np.full((48, 64), 2.0), np.full((48, 64), 3.0)
    new = np.where(column[None, :] < own, 2.0, 5.0 + np.sin(np.arange(48 * 64).reshape(48, 64)))
    other = np.where(column[None, ::-1] < others_share, new, other)
    thumbs = [Thumb.of(np.float32(image)) for image in (new, old, other)]
    pairs = pairs_of(thumbs[0], thumbs[1], STRETCH)
    found = oddity(thumbs[0], thumbs[1], pairs, {"c1": thumbs[2]})
    agreeing = pairs_of(thumbs[0], thumbs[2], STRETCH).agreeing
    is_anothers = agreeing >= 0.6 and pairs.agreeing <= agreeing / 2
    assert (found is not None and found.cause is HealthCause.CAMERA_SWAPPED) == is_anothers


@settings(max_examples=50)
@given(st.integers(0, 40), st.integers(8, 24), st.integers(20, 48), st.floats(0.4, 1.4))
def test_a_person_who_walks_by_is_nothing_odd(at, wide, high, depth_m):
    image = SENSOR.image()
    body = depth_m * (1 + 0.1 * np.sin(np.linspace(0, np.pi, min(wide, 64 - at))))
    image[-high:, at : at + wide] = body
    new, old = Thumb.of(np.float32(image)), Thumb.of(SENSOR.image())
    assert agrees(new, old)


@given(st.integers(0, 2**32 - 1))
def test_two_images_of_a_sensor_are_never_equal_and_one_is_always_equal_to_itself(seed):
    one, other = (Thumb.of(Sensor(CAMERA, seed=seed + n).image()) for n in range(2))
    assert equal_share(one, other) == 0
    assert equal_share(one, one) == 1


@pytest.mark.parametrize("empty", [0.0, np.nan, np.inf, -1.0])
def test_without_returns_nothing_can_be_told(empty):
    nothing = Thumb.of(np.full((48, 64), empty, dtype=np.float32))
    seen = Thumb.of(SENSOR.image())
    assert equal_share(nothing, nothing) is None
    assert agrees(nothing, seen) is None and pairs_of(nothing, seen, STRETCH) is None
    assert nothing.share == 0 and nothing.smooth == 0


@given(st.integers(1, 700), st.integers(1, 500))
def test_tiles_count_what_a_plain_count_does(width, height):
    random = np.random.default_rng(width * 1000 + height)
    thumb = Thumb.of(np.where(random.random((height, width)) < 0.7, 1.0, 0.0).astype(np.float32))
    counts, sizes = thumb.returned_per_tile, thumb.tile_sizes
    rows, columns = thumb.depth_m.shape
    side = max(4, -(-columns // 16))
    for row in range(len(counts)):
        for column in range(counts.shape[1]):
            tile = thumb.returned[row * side : (row + 1) * side, column * side : (column + 1) * side]
            assert (counts[row, column], sizes[row, column]) == (tile.sum(), tile.size)
    assert sizes.sum() == rows * columns


@given(st.floats(0.0, 1.0), st.booleans())
def test_the_share_of_tiles_that_are_lost_is_what_is_taken(share, commissioned):
    image = SENSOR.image()
    cover = Cover.unknown(Thumb.of(image))
    if commissioned:
        spots = np.zeros_like(image)
        spots[::2] = walls(CAMERA)[::2]
        cover = Cover.commissioned(Thumb.of(spots))
        assert cover.usual.min() == 1
    for _ in range(10):
        cover = cover.learning(Thumb.of(SENSOR.image()))
    taken = round(share * 16) * 4  # whole columns of tiles
    image[:, :taken] = 0
    assert cover.is_settled
    # spots are few, so that those of two columns of tiles are counted together
    assert cover.lost(Thumb.of(image)) == pytest.approx(taken / 64, abs=1 / 16 if commissioned else 1e-6)
