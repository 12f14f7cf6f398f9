"""Reaction times: from the exposure before to the decision, term by term, the worst of each kept."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.monitor.separation.reaction import Reaction, ReactionWatch
from elbowroom.sensing import DepthFrame, Snapshot

MS = 1_000_000
IMAGE = np.ones((2, 2), np.float32)


def at(now_ms, bounds=None, **stamps_ms):
    frames = tuple(
        DepthFrame(name, None if ms is None else round(ms * MS), IMAGE) for name, ms in stamps_ms.items()
    )
    return Snapshot(frames, now_ns=round(now_ms * MS), clock_bounds_ns=bounds or {})


def test_a_reaction_time_is_from_the_exposure_before_to_the_decision():
    watch = ReactionWatch()
    assert watch.add(at(100, a=90, b=95), 30, 1) is None and watch.worst is None and watch.row() == {}
    reaction = watch.add(at(160, a=150, b=130), 40, 2)
    # a: 90 to 160 and 42 beyond; b: 95 to 160
    assert reaction == Reaction(period_ms=60, age_ms=10, pass_ms=40, output_ms=2)
    assert reaction.total_ms == 160 + 42 - 90
    # b: 35 ms and 30 ms of age: the sum of the worst terms is more than any reaction time
    assert watch.worst == Reaction(60, 30, 40, 2)
    assert watch.greatest_ms == reaction.total_ms < watch.worst.total_ms


def test_an_image_that_stays_the_same_counts_until_the_next_one_comes():
    watch = ReactionWatch()
    watch.add(at(100, a=90), 5, 0)
    assert watch.add(at(150, a=90), 5, 0) is None
    assert watch.add(at(200, a=190), 5, 0) == Reaction(100, 10, 5, 0)


def test_a_camera_that_falls_silent_is_known_to_be_when_nothing_of_it_is_used():
    watch = ReactionWatch(max_age_ns=60 * MS)
    watch.add(at(100, a=90, b=95), 5, 0)
    assert watch.add(at(155, a=150, b=95), 5, 0) == Reaction(60, 5, 5, 0)
    # b is too old now, and frees nothing: what it has missed since 95 is blocked from here on
    assert watch.add(at(160, a=150, b=95), 5, 0) == Reaction(65, 0, 5, 0)
    # when it comes back, nobody had relied on it
    assert watch.add(at(1000, a=990, b=995), 5, 0).total_ms < 900


def test_what_a_clock_is_not_known_to_is_age():
    watch = ReactionWatch()
    watch.add(at(100, a=90), 0, 0)
    assert watch.add(at(200, {"a": 7 * MS}, a=190), 0, 0).age_ms == 17


def test_without_times_nothing_is_known():
    watch = ReactionWatch()
    for _ in range(3):
        assert watch.add(Snapshot((DepthFrame("a", None, IMAGE),)), 5, 0) is None
        assert watch.add(at(100, a=None), 5, 0) is None


@given(
    st.lists(
        st.tuples(st.floats(1, 90), st.floats(0, 30), st.floats(0, 50), st.floats(0, 5)),
        min_size=2,
        max_size=9,
    )
)
def test_the_worst_is_never_less_than_any(passes):
    watch, now, found = ReactionWatch(), 0.0, []
    for step, age, took, out in passes:
        now += step
        found.append(watch.add(at(now + 100, a=now + 100 - age), took, out))
    for reaction in found:
        assert reaction is None or reaction.total_ms <= watch.greatest_ms <= watch.worst.total_ms + 1e-9


def test_terms_add_up():
    assert Reaction(1, 2, 3, 4).row() == {
        "period_ms": 1,
        "age_ms": 2,
        "pass_ms": 3,
        "output_ms": 4,
        "total_ms": pytest.approx(10),
    }
