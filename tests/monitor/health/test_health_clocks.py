"""Stamps of a live source that go back, stand still, run ahead or lie far apart are a stop."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.monitor.health.clocks import Clocks
from elbowroom.sensing import DepthFrame, Snapshot

MS = 1_000_000
EPOCH = 1_700_000_000_000 * MS
ONE, OTHER = np.ones((2, 2), np.float32), np.full((2, 2), np.nan, np.float32)


class Ticks:
    """A clock of the computer that says what the test says."""

    now_ns = 0

    def __call__(self) -> int:
        return self.now_ns


def moment(now_ns: int | None, *stamps: int | None, images=None) -> Snapshot:
    images = images or [ONE] * len(stamps)
    frames = [
        DepthFrame(f"c{n}", stamp, image) for n, (stamp, image) in enumerate(zip(stamps, images, strict=True))
    ]
    return Snapshot(tuple(frames), None, now_ns=now_ns)


def heard(*snapshots: Snapshot, **more) -> list[list[str]]:
    clocks = Clocks(clock_ns=Ticks(), **more)
    return [[f.kind for f in clocks.hear(snapshot) if f.stops] for snapshot in snapshots]


@settings(max_examples=30)
@given(
    seed=st.integers(0, 9999),
    rate_hz=st.sampled_from([5, 15, 30, 90]),
    first=st.sampled_from([0, EPOCH]),
    pass_ms=st.sampled_from([10, 40, 250]),
)
def test_cameras_that_run_freely_and_lose_images_are_no_finding(seed, rate_hz, first, pass_ms):
    """Each snapshot has the newest image of each camera; passes may be shorter or longer than a camera's step."""
    random = np.random.default_rng(seed)
    step = round(1e9 / rate_hz)
    phases = random.integers(0, step, 4)
    ticks = Ticks()
    clocks = Clocks(clock_ns=ticks)
    for number in range(60):
        now = first + 2 * step + number * pass_ms * MS
        ticks.now_ns = number * pass_ms * MS
        stamps = [now - (now - first - int(phase)) % step for phase in phases]
        found = clocks.hear(moment(now, *map(int, stamps)))
        assert found == (), found


def test_an_image_that_is_older_than_one_before_is_a_stop_until_its_camera_is_past_it():
    steps = [100, 200, 150, 200, 250]
    said = heard(*(moment(EPOCH + 300 * MS, EPOCH + n * MS) for n in steps))
    assert said == [[], [], ["order"], [], []]


def test_a_camera_whose_clock_was_set_back_stays_a_stop():
    said = heard(*(moment(None, stamp) for stamp in (EPOCH, EPOCH + 33 * MS, 5_000 * MS, 5_033 * MS)))
    assert said == [[], [], ["order"], ["order"]]


def test_a_clock_of_the_computer_that_was_set_back_is_a_stop():
    assert heard(moment(EPOCH, 0), moment(EPOCH - 10, 1), moment(EPOCH, 2)) == [[], ["clock"], []]


def test_a_camera_that_was_unplugged_repeats_its_image_and_is_no_stop_but_another_image_of_one_time_is():
    again = moment(EPOCH, EPOCH, images=[ONE.copy()])
    assert heard(moment(EPOCH, EPOCH), again, moment(EPOCH, EPOCH, images=[OTHER])) == [[], [], ["order"]]
    assert heard(moment(0, 0, images=[OTHER]), moment(0, 0, images=[OTHER.copy()])) == [[], []]


def test_a_stamp_ahead_of_the_clock_is_a_stop():
    assert heard(moment(EPOCH, EPOCH + 99 * MS), moment(EPOCH, EPOCH + 201 * MS)) == [[], ["clock"]]


def test_images_farther_apart_than_cameras_give_them_are_no_one_moment():
    steady = [moment(None, EPOCH + n * 33 * MS, EPOCH + n * 33 * MS + 16 * MS) for n in range(5)]
    later = moment(None, EPOCH + 200 * MS, EPOCH + 900 * MS)
    assert heard(*steady, later)[-1] == ["skew"]
    assert heard(moment(None, 0, 24_500 * MS)) == [["skew"]]
    # slow cameras may be farther apart
    slow = [moment(None, n * 2_000 * MS, n * 2_000 * MS + 900 * MS) for n in range(5)]
    assert heard(*slow) == [[]] * 5


def test_what_is_past_its_age_is_left_out_anyway_and_no_skew():
    dead = [moment(EPOCH + n * 33 * MS, EPOCH + n * 33 * MS, EPOCH) for n in range(100)]
    assert heard(*dead, max_age_ns=200 * MS) == [[]] * 100
    assert heard(*dead)[-1] == ["skew"]


@pytest.mark.parametrize(("unit", "kinds"), [(1, []), (1_000, ["unit"]), (1_000_000, ["unit"])])
def test_stamps_in_another_unit_go_too_slowly(unit, kinds):
    """All that was in nanoseconds is divided: steps, limits and skews look well, and only the clock tells."""
    ticks = Ticks()
    clocks = Clocks(clock_ns=ticks)
    for number in range(40):
        ticks.now_ns = number * 33 * MS
        now = (EPOCH + number * 33 * MS) // unit
        found = clocks.hear(moment(now, now, now))
    assert [finding.kind for finding in found if finding.stops] == kinds


def test_a_recording_may_be_slow_may_have_gaps_and_its_layout_looks_at_skews():
    hour = 3_600_000 * MS
    clocks = Clocks(recorded=True, clock_ns=Ticks())
    found = [
        clocks.hear(moment(stamp, stamp, stamp - 900 * MS))
        for stamp in (EPOCH, EPOCH + 500 * MS, EPOCH + hour)
    ]
    assert found[:2] == [(), ()]
    (gap,) = found[2]
    assert gap.kind == "gap" and not gap.stops and "nothing was recorded for 60 min 0 s: skipped" in gap.text


def test_images_without_times_are_not_looked_at():
    assert heard(moment(None, None, None), moment(None, None)) == [[], []]


@given(st.integers(150, 10**7), st.integers(10, 90), st.integers(4, 30), st.integers(0, 2**16))
def test_a_clock_that_is_set_ahead_is_a_stop_for_a_second(by_ms, step_ms, before, seed):
    ticks, random = Ticks(), np.random.default_rng(seed)
    clocks, late = Clocks(clock_ns=ticks), random.integers(0, step_ms, before + 200)
    said = []
    for number in range(before + 200):
        now_ms = number * step_ms + (by_ms + 2 * step_ms if number >= before else 0)
        ticks.now_ns = (number * step_ms + int(late[number])) * MS
        said.append([f.kind for f in clocks.hear(moment(EPOCH + now_ms * MS)) if f.stops])
        if number * step_ms > before * step_ms + 1500:
            break
    assert not any(said[:before]) and said[before] == ["clock"]
    assert said[-1] == []


@given(st.lists(st.integers(1, 2000), min_size=3, max_size=40), st.integers(0, 2**16))
def test_passes_of_any_length_are_no_jump_of_the_clock(steps_ms, seed):
    """The time is taken when a snapshot begins to be brought, which takes as long as it takes."""
    ticks, random = Ticks(), np.random.default_rng(seed)
    clocks, at_ms = Clocks(clock_ns=ticks), 0
    for step_ms in steps_ms:
        now_ms = at_ms + int(random.integers(0, step_ms))
        at_ms += step_ms
        ticks.now_ns = at_ms * MS
        assert clocks.hear(moment(EPOCH + now_ms * MS)) == ()


def test_a_source_that_runs_faster_than_the_clock_does_not_jump():
    ticks = Ticks()
    clocks = Clocks(clock_ns=ticks)
    for number in range(40):
        ticks.now_ns = number * 10 * MS
        assert clocks.hear(moment(EPOCH + number * 300 * MS)) == ()
