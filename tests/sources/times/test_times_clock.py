"""The model of a camera's clock: what it says beside the clock that made the stamps."""

import itertools
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.sources.times.clock import BUCKET_NS, DRIFT_LIMIT, WINDOW_NS, Clock, lower_hull

MS, S = 1_000_000, 1_000_000_000
T0 = 1_700_000_000 * S


class Camera:
    """Images of a clock that is so far off and goes so fast, with delays of at least `least_ns`."""

    def __init__(self, offset_ns, ppm, least_ns, jitter_ns, seed, step_ns=33 * MS):
        self.offset_ns, self.rate, self.least_ns, self.jitter_ns = offset_ns, ppm * 1e-6, least_ns, jitter_ns
        self.chance, self.step_ns = random.Random(seed), step_ns

    def apart_ns(self, at_ns):
        """The monitor's clock less the camera's, and the least delay."""
        return self.offset_ns + self.least_ns + round(self.rate * (at_ns - T0))

    def images(self, begin_s, end_s):
        """Arrival and stamp."""
        found = []
        for exposed in range(T0 + int(begin_s * S), T0 + int(end_s * S), self.step_ns):
            delay = self.least_ns + round(self.chance.expovariate(1) * self.jitter_ns)
            stamp = exposed - self.offset_ns - round(self.rate * (exposed - T0))
            found.append((exposed + delay, stamp))
        return sorted(found)


def heard(images, **more):
    clock = Clock(**more)
    for arrival, stamp in images:
        clock.hear(arrival, stamp)
    return clock


@settings(max_examples=60)
@given(
    offset=st.one_of(st.integers(-S, S), st.integers(-T0, T0)),
    ppm=st.floats(-180, 180),
    least=st.integers(0, 80 * MS),
    jitter=st.integers(0, 20 * MS),
    seed=st.integers(0, 999),
)
def test_the_truth_lies_within_the_bound(offset, ppm, least, jitter, seed):
    camera = Camera(offset, ppm, least, jitter, seed)
    images = camera.images(0, 25)
    clock = Clock()
    for number, (arrival, stamp) in enumerate(images):
        clock.hear(arrival, stamp)
        if number % 50 == 49:
            found = clock.at(arrival)
            # a part of the window is dropped as a whole
            window = [(at, s) for at, s in images[: number + 1] if at >= arrival - WINDOW_NS + BUCKET_NS]
            quickest = min((at - s) - camera.apart_ns(at) for at, s in window)
            truth = camera.apart_ns(arrival) + quickest
            assert abs(found.offset_ns - truth) <= found.bound_ns
            # and never above what an image has shown to be possible
            slack, slope = DRIFT_LIMIT * BUCKET_NS + 2, found.drift_ppm * 1e-6
            assert all(at - s >= found.offset_ns + slope * (at - arrival) - slack for at, s in window)
    assert found.is_settled


@pytest.mark.parametrize("ppm", (-150, 0, 40, 150))
def test_steady_cameras_are_known_closely(ppm):
    camera = Camera(3600 * S, ppm, 15 * MS, 2 * MS, 1)
    images = camera.images(0, 30)
    found = heard(images).at(images[-1][0])
    assert found.offset_ns == pytest.approx(camera.apart_ns(images[-1][0]), abs=0.6 * MS)
    assert found.drift_ppm == pytest.approx(ppm, abs=60)
    assert found.bound_ns < 7 * MS


def test_a_clock_that_was_set_widens_the_bound_until_it_is_known_again():
    before, after = Camera(0, 0, 10 * MS, MS, 1), Camera(-40 * MS, 0, 10 * MS, MS, 2)
    clock = heard(before.images(0, 15))
    calm = clock.at(T0 + 15 * S)
    for arrival, stamp in after.images(15, 15.3):
        clock.hear(arrival, stamp)
    stirred = clock.at(arrival)
    # the stamps are 40 ms ahead now: the age of an image is not less than the bound
    assert stirred.bound_ns > 40 * MS > calm.bound_ns
    for arrival, stamp in after.images(15.3, 28):
        clock.hear(arrival, stamp)
    again = clock.at(arrival)
    assert again.bound_ns < 10 * MS and again.offset_ns == pytest.approx(-30 * MS, abs=MS)


def test_the_bound_grows_while_nothing_comes():
    images = Camera(0, 0, 10 * MS, MS, 1).images(0, 12)
    clock = heard(images)
    last = images[-1][0]
    bounds = [clock.at(last + s * S).bound_ns for s in (0, 60, 3600)]
    assert bounds == sorted(bounds) and bounds[2] >= 2 * DRIFT_LIMIT * 3600 * S


def test_little_is_known_at_first_and_nothing_before():
    clock = Clock()
    assert clock.at(T0) is None
    clock.hear(T0, T0 - 5 * MS)
    found = clock.at(T0)
    assert (found.offset_ns, found.drift_ppm, found.is_settled) == (5 * MS, 0.0, False)
    assert found.bound_ns == 2 * DRIFT_LIMIT * (WINDOW_NS + BUCKET_NS)
    # the recorder's clock was set back: what was heard before says nothing any more
    clock.hear(T0 - 60 * S, T0)
    assert clock.at(T0 - 60 * S).offset_ns == -60 * S


def test_memory_does_not_grow():
    clock = heard(Camera(0, 0, MS, MS, 3).images(0, 200))
    assert len(clock._least) <= WINDOW_NS // clock.bucket_ns + 2


@given(st.lists(st.integers(-50, 50), min_size=1, max_size=12))
def test_the_hull_lies_below_all_points_and_touches_them(heights):
    points = list(enumerate(heights))
    hull = lower_hull(points)
    assert hull[0] == points[0] and hull[-1] == points[-1] and set(hull) <= set(points)
    for (ax, ay), (bx, by) in itertools.pairwise(hull):
        assert all((y - ay) * (bx - ax) >= (by - ay) * (x - ax) for x, y in points if ax <= x <= bx)
