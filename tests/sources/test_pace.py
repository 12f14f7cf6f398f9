"""Recorded moments come no faster than they were taken."""

import pytest

from elbowroom.sensing import Snapshot
from elbowroom.sources import pace
from elbowroom.sources.pace import Pace


@pytest.fixture
def clock(monkeypatch):
    """A clock that only sleeping moves, and what was slept."""

    class Clock:
        now_s, slept = 100.0, []

        def perf_counter(self):
            return self.now_s

        def sleep(self, seconds):
            self.now_s += seconds
            self.slept.append(pytest.approx(seconds))

    made = Clock()
    monkeypatch.setattr(pace, "time", made)
    return made


def at(time_s):
    return Snapshot((), now_ns=round(time_s * 1e9))


def test_a_moment_waits_until_it_is_as_late_as_it_was(clock):
    waiting = Pace()
    for time_s in (7.0, 7.5, 7.6):
        waiting.wait(at(time_s))
    assert clock.slept == [0.5, 0.1]


def test_who_is_late_does_not_wait_and_does_not_fall_further_behind(clock):
    waiting = Pace()
    waiting.wait(at(7.0))
    clock.now_s += 2.0
    waiting.wait(at(8.0))
    waiting.wait(at(9.5))
    assert clock.slept == [0.5]


def test_a_gap_is_skipped_and_the_time_counts_anew_from_behind_it(clock):
    waiting = Pace(gap_ns=5_000_000_000)
    for time_s in (7.0, 7.5, 3607.5, 3608.0, 1.7e9, 1.7e9 + 0.25, 3.0, 3.5):
        waiting.wait(at(time_s))
    assert clock.slept == [0.5, 0.5, 0.25, 0.5]


def test_what_is_early_is_told_without_waiting(clock):
    waiting = Pace()
    assert [waiting.early_s(at(time_s)) for time_s in (7.0, 9.0)] == [0.0, 2.0]
    assert clock.slept == []


def test_moments_without_times_come_as_fast_as_they_are_read(clock):
    waiting = Pace()
    for _ in range(3):
        waiting.wait(Snapshot(()))
    assert clock.slept == []
