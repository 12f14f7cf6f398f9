"""A camera whose view is hidden, or that gives nothing, is named and stops after its time; a passer-by stops none."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.monitor import Condition, Watch
from elbowroom.monitor.health.drift.lasting import LIMITS_S, Lasting
from elbowroom.sensing import DepthFrame, Snapshot
from reference.watch_twins import CAMERAS, NOISE_M, commissioned, frame

SECOND = 1_000_000_000
PERIOD = SECOND // 10
REFERENCES = commissioned(CAMERAS)
PLAIN = {camera.name: frame(camera, 0, NOISE_M).depth_m for camera in CAMERAS}


def hear(watch, seconds, start_s=0.0, change=lambda image, k: image):
    """Hears all cameras ten times a second; `change` takes the image of `low` and gives it, or None."""
    health = None
    for k in range(round(seconds * 10)):
        stamp = round(start_s * SECOND) + k * PERIOD
        images = {**PLAIN, "low": change(PLAIN["low"], k)}
        frames = [DepthFrame(name, stamp, image) for name, image in images.items() if image is not None]
        health = watch.hear(Snapshot.taken(frames, None, stamp))
    return health


def cloth(share, depth_m=0.25):
    """Hangs over so much of the image from the left; 0: no return from it."""

    def change(image, k):
        hidden = image.copy()
        hidden[:, : round(share * image.shape[1])] = depth_m
        return hidden

    return change


@pytest.mark.parametrize(
    ("change", "condition", "words"),
    [
        (cloth(0.85), Condition.HIDDEN, "mostly hidden: 8"),
        (cloth(0.85, 0.0), Condition.HIDDEN, "mostly hidden: 8"),
        (cloth(1.0), Condition.COVERED, "covered: 100 % of what it was commissioned on"),
        (cloth(1.0, 0.0), Condition.BLIND, "gives no returns: 100 %"),
        (lambda image, k: None, Condition.SILENT, "gives no new image"),
    ],
)
def test_it_is_named_at_once_and_stops_after_its_time_and_not_before(change, condition, words):
    watch, limit_s = Watch(CAMERAS, REFERENCES), LIMITS_S[condition]
    assert hear(watch, 1).reason is None
    health = hear(watch, limit_s - 0.3, 1.0, change)
    assert health.reason is None
    low = health.cameras[-1]
    assert low.camera == "low" and low.condition is condition and low.share_hidden > 0.8
    health = hear(watch, 1, 1 + limit_s - 0.3, change)
    assert list(health.stops) == ["low"] and words in health.reason
    # and it stays when the cause is gone
    assert hear(watch, 5, 100).stops == health.stops


def test_who_stands_before_a_camera_for_a_while_and_goes_stops_nothing():
    watch = Watch(CAMERAS, REFERENCES)
    for round_ in range(6):
        assert hear(watch, 40, 100 * round_, cloth(0.85, 0.6)).reason is None
        assert hear(watch, 1, 100 * round_ + 40).reason is None


def test_a_cloth_that_slips_to_and_fro_is_hidden_all_the_time():
    one, other = cloth(0.8), cloth(1.0)

    def slipping(image, k):
        return one(image, k) if k // 20 % 2 else other(image, k)

    health = hear(Watch(CAMERAS, REFERENCES), LIMITS_S[Condition.HIDDEN] + 1, change=slipping)
    assert list(health.stops) == ["low"] and "for 60 s" in health.reason


def test_a_hidden_camera_that_is_knocked_is_still_named_for_it():
    # a quarter of the image shows the walls 4 cm nearer, the rest is hidden
    def change(image, k):
        return cloth(0.75)(image - np.float32(0.04), k)

    health = hear(Watch(CAMERAS, REFERENCES), 10, change=change)
    assert list(health.stops) == ["low"] and "moved" in health.reason


def test_a_camera_that_repeats_one_frame_is_silent_too():
    watch = Watch(CAMERAS, REFERENCES)
    stuck = DepthFrame("low", 5, PLAIN["low"])
    for k in range(30):
        now = k * PERIOD
        others = [DepthFrame(name, now, image) for name, image in PLAIN.items() if name != "low"]
        health = watch.hear(Snapshot.taken([*others, stuck], None, now))
    assert list(health.stops) == ["low"] and "no new image" in health.reason


def test_a_camera_that_comes_only_in_the_passes_that_pass_it_over_is_not_silent():
    health = hear(Watch(CAMERAS, REFERENCES), 10, change=lambda image, k: image if k % 2 else None)
    assert health.reason is None
    health = hear(Watch(CAMERAS, REFERENCES), 10, change=lambda image, k: None if k % 2 else image)
    assert health.reason is None


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(1, 20)), max_size=60))
def test_a_condition_lasts_as_long_as_every_frame_says_it(steps):
    """Beside a twin that looks back over all that was said."""
    order = (Condition.HIDDEN, Condition.COVERED, Condition.BLIND)
    lasting, now, heard = Lasting(), 0, []
    for severity, wait in steps:
        now += wait * SECOND
        lasting.seen(set(order[:severity]), now)
        heard.append((now, severity))
        wanted = None
        for level, condition in ((3, Condition.BLIND), (2, Condition.COVERED), (1, Condition.HIDDEN)):
            first = now
            for stamp, said in reversed(heard):
                if said < level:
                    break
                first = stamp
            if severity >= level and now - first >= LIMITS_S[condition] * SECOND and wanted is None:
                wanted = condition, (now - first) / SECOND
        assert lasting.too_long == wanted
