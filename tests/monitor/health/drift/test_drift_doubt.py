"""A camera that is turned is in doubt at its first image that is listened to; whoever walks by brings no doubt."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import DepthCamera
from elbowroom.monitor.health.drift.camera_watch import CameraWatch
from elbowroom.monitor.health.drift.doubt import CLEARS_AFTER, DECIDES, Doubt, Shares, shares_of
from elbowroom.monitor.health.drift.kernels.watch import FITS_M, FITS_SIGMAS, Gate
from elbowroom.sensing import DepthFrame
from reference.watch_twins import CAMERAS, NOISE_M, commissioned, frame, knocked

STEP_NS = 66_666_667
REFERENCES = commissioned(CAMERAS)


def heard(watch: CameraWatch, camera: DepthCamera, number: int, change=lambda depth: depth):
    """What the watch of a camera says of one more image."""
    stamp = number * STEP_NS
    seen = frame(camera, stamp, NOISE_M, np.random.default_rng(number))
    now = DepthFrame(seen.camera, stamp, np.float32(change(seen.depth_m)))
    return watch.hear(now, stamp)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("turn_deg", [-15, -4, 2, 4, 8, 30])
def test_a_camera_that_is_turned_is_in_doubt_at_once_and_named_soon(axis: int, turn_deg: float) -> None:
    for camera, reference in zip(CAMERAS, REFERENCES, strict=True):
        watch = CameraWatch(camera, reference)
        for number in range(10):
            assert heard(watch, camera, number).doubt is None
        turned = knocked(camera, tuple(turn_deg * np.eye(3)[axis]))
        for number in range(10, 10 + DECIDES):
            said = heard(watch, turned, number)
            # no image between the knock and its name is without a doubt
            assert watch.stop is not None or said.doubt is not None
        assert watch.stop is not None


def test_a_camera_that_comes_back_is_not_in_doubt_any_more() -> None:
    watch = CameraWatch(CAMERAS[0], REFERENCES[0])
    for number in range(10):
        heard(watch, CAMERAS[0], number)
    assert heard(watch, knocked(CAMERAS[0], (0, 4, 0)), 10).doubt is not None
    doubts = [heard(watch, CAMERAS[0], 11 + n).doubt is not None for n in range(CLEARS_AFTER + 2)]
    assert doubts[0] and not any(doubts[CLEARS_AFTER:]) and watch.stop is None


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_whoever_walks_by_or_leans_on_a_wall_brings_no_doubt(seed: int) -> None:
    rng = np.random.default_rng(seed)
    place, speed, half = rng.uniform(0, 80), rng.uniform(-4, 4), rng.uniform(4, 30)
    distance, thick, top = rng.uniform(0.4, 3), rng.uniform(0.02, 0.25), rng.uniform(0, 40)
    v, u = np.mgrid[:60, :80]
    for camera, reference in zip(CAMERAS, REFERENCES, strict=True):
        watch = CameraWatch(camera, reference)
        for number in range(30):
            body = (np.abs(u - (place + speed * number) % 80) < half) & (v > top)
            leans = (np.abs(u - 40) < half / 4) & (v > top)

            def before(depth, body=body, leans=leans):
                return np.minimum(np.where(body, distance, depth), np.where(leans, depth - thick, depth))

            assert heard(watch, camera, number, before).doubt is None
        assert watch.stop is None


def test_lost_returns_bring_no_doubt_and_a_view_that_is_hidden_cannot_tell() -> None:
    watch = CameraWatch(CAMERAS[0], REFERENCES[0])
    rng = np.random.default_rng(5)
    for number, share in enumerate((0.0, 0.3, 0.9, 1.0)):
        lost = rng.random((60, 80)) < share
        assert (
            heard(watch, CAMERAS[0], number, lambda depth, lost=lost: np.where(lost, 0, depth)).doubt is None
        )


def test_what_is_never_confirmed_is_taken_back_and_comes_again_only_anew() -> None:
    doubt = Doubt()
    said = []
    for _ in range(2 * DECIDES):
        doubt.hear("may be elsewhere")
        said.append(doubt.text)
        doubt.hear(None, can_tell=False)  # a hidden view says nothing
        assert doubt.text == said[-1]
    assert all(said[:DECIDES]) and not any(said[DECIDES:])
    doubt.hear(None)
    doubt.hear("may be elsewhere")
    assert doubt.text is None
    for _ in range(CLEARS_AFTER):
        doubt.hear(None)
    doubt.hear("may be elsewhere")
    assert doubt.text == "may be elsewhere"


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_shares_are_those_of_a_count_spot_by_spot(seed: int) -> None:
    rng, spots, gate = np.random.default_rng(seed), REFERENCES[1].spots(), Gate(0.1, 9.0, 0.2)
    image = np.zeros(60 * 80, dtype=np.float32)
    image[spots.pixel] = spots.depth * rng.normal(1, 0.05, len(spots.depth))
    image[rng.integers(0, image.size, 300)] = rng.choice([0, np.nan, np.inf, -1, 20], 300)
    shown = through = off = 0
    for i, pixel in enumerate(spots.pixel):
        depth = float(image[pixel])
        if not (0.1 <= depth <= 9.0):
            continue
        away = (depth - spots.depth[i]) * spots.scale[i]
        if away < -(0.2 + 4 * spots.sigma[i]):
            continue
        near = FITS_M + FITS_SIGMAS * spots.sigma[i]
        shown, through, off = shown + 1, through + (away > near), off + (abs(away) > near)
    assert shares_of(image, spots, gate) == pytest.approx(Shares(shown, through / shown, off / shown))
