"""The greatest safe speed: monotone, between 0 and 1, and what its formula says."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.motion import Cause, JointPath, Level, Motion, Verdict, check_motions, machine_speed
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_ball

GRID = room(0.1)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def verdict(motion, travel, cause=Cause.SURFACE):
    return Verdict(motion, Level.at(travel, motion.braking_distance), travel, "m", None, None, cause)


@pytest.mark.parametrize(
    ("travel", "share"), [(0.0, 0.0), (0.05, 0.0), (0.1, 0.25), (0.15, 0.5), (0.25, 1.0), (9.0, 1.0)]
)
def test_the_stopping_travel_at_the_safe_speed_fits_into_the_free_travel_less_the_clearance(travel, share):
    motion = Motion("slide", 1, 0.12, reach=10.0, reaction_distance=0.08, clearance=0.05)
    speed = verdict(motion, travel).safe_speed
    assert speed == pytest.approx(share)
    if 0 < speed < 1:
        assert speed * (0.12 + 0.08) == pytest.approx(travel - 0.05)


def test_a_joint_limit_holds_nothing_back_and_what_was_not_looked_at_does():
    motion = Motion("slide", 1, 0.1)
    assert verdict(motion, 0.0, Cause.NONE).safe_speed == 1.0
    short = Motion("slide", 1, 0.1, reach=0.05)
    assert verdict(short, 0.05, Cause.NONE).safe_speed == pytest.approx(0.5)
    for cause in (Cause.FAULT, Cause.STALE, Cause.INPUT, Cause.WATCH):
        assert Verdict.stop(motion, "m", cause).safe_speed == 0.0
    assert verdict(JointPath([{"slide": 1.0}], 0.2), 0.1).safe_speed == pytest.approx(0.5)


def test_the_machine_is_as_slow_as_the_slowest_of_what_it_does():
    fast, slow = Motion("slide", 1, 0.1), Motion("turn", -1, 0.1)
    verdicts = [verdict(fast, 0.08), verdict(slow, 0.02)]
    assert machine_speed(verdicts) == pytest.approx(0.2)
    assert machine_speed(verdicts, {"slide": 0.1, "turn": 0.0}) == pytest.approx(0.8)
    assert machine_speed(verdicts, {"slide": 0.1, "turn": 0.1}) == pytest.approx(0.8)
    assert machine_speed(verdicts, {"slide": 0.1}) == pytest.approx(0.2)
    assert machine_speed(verdicts, {"slide": 0.0, "turn": 0.0}) == pytest.approx(0.2)
    assert machine_speed(verdicts, {"slide": 0.1, "turn": math.nan}) == pytest.approx(0.2)
    with pytest.raises(InputError, match="must stop"):
        machine_speed([])


@pytest.mark.parametrize("name", ["reaction_distance", "clearance"])
@pytest.mark.parametrize("value", [-0.1, math.nan, math.inf])
def test_distances_that_are_none_are_refused(name, value):
    with pytest.raises(InputError, match=name):
        Motion("slide", 1, 0.1, **{name: value})


balls = st.tuples(
    st.tuples(st.floats(-1.2, 1.2), st.floats(-1.2, 1.2), st.floats(-0.2, 1.0)), st.floats(0.05, 0.3)
)


@settings(max_examples=40)
@given(st.lists(balls, max_size=3), balls, st.floats(0, 0.3), st.floats(0, 0.2))
def test_less_evidence_never_gives_more_speed(arm, seen, unseen, reaction, clearance):
    motions = [
        Motion(joint, way, 0.2, None, reaction, clearance) for joint in ("slide", "turn") for way in (1, -1)
    ]
    blocked = nothing_in(GRID)
    for ball in seen:
        blocked |= touched_by_ball(GRID, *ball)
    less = blocked | touched_by_ball(GRID, *unseen)
    before, after = (
        check_motions(FreeSpace.from_occupied(GRID, each).without(arm, HOME), arm, HOME, motions)
        for each in (blocked, less)
    )
    for one, other in zip(before, after, strict=True):
        assert 0.0 <= other.safe_speed <= one.safe_speed <= 1.0
    assert machine_speed(after) <= machine_speed(before)
