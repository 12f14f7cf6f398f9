"""The rest of a path from where the machine is, and what it leaves of the motions: never more than they had."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import JointsError
from elbowroom.motion import (
    Braking,
    Cause,
    Level,
    Motion,
    PathVerdict,
    Trajectory,
    check_motions,
    check_rest,
    rest_of,
    with_path,
)
from elbowroom.motion.meant import HORIZON_S, LAG_S, share_of
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)
NAMES = ("slide", "turn", "nod")
FULL = Braking(dict.fromkeys(NAMES, 1.0), {"slide": 0.4, "turn": 0.6, "nod": 0.2})
MOTIONS = [Motion(name, way, 0.05) for name in NAMES for way in (1, -1)]
WALL = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
"""0.26 m before the hand's front at home."""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def sliding(begin_s: float, speed: float = 0.2, seconds: float = 2.4) -> Trajectory:
    return Trajectory(("slide",), [begin_s, begin_s + seconds], [[0.0], [speed * seconds]])


@settings(max_examples=30)
@given(st.floats(0.0, 2.3), st.floats(0.0, LAG_S))
def test_the_rest_begins_where_the_machine_is_though_it_lags(gone_s: float, lag_s: float) -> None:
    joints = {**HOME, "slide": 0.2 * max(gone_s - lag_s, 0.0)}
    rest = rest_of(sliding(-gone_s), joints)
    assert rest is not None and abs(rest.path.positions[0, 0] - joints["slide"]) <= 0.2 * LAG_S / 20 + 1e-9
    assert rest.path.positions[-1, 0] == pytest.approx(0.48) and rest.made["slide"] == {1}


def test_before_its_time_all_of_it_is_left_and_after_it_nothing() -> None:
    rest = rest_of(sliding(1.5), HOME)
    assert rest is not None and rest.path.begin_s == 1.5 and rest.path.end_s == 3.9
    assert rest_of(sliding(-2.6), {**HOME, "slide": 0.48}) is None
    with pytest.raises(JointsError, match="slide has no position"):
        rest_of(sliding(0.0), {"turn": 0.0})


def test_a_machine_that_is_not_on_its_path_is_said(arm) -> None:
    space = FreeSpace.from_occupied(GRID, nothing_in(GRID)).without(arm, HOME)
    rest = rest_of(sliding(-1.0), {**HOME, "slide": 0.0})
    with pytest.raises(JointsError, match="slide"):
        check_rest(space, arm, {**HOME, "slide": 0.0}, rest, FULL)


@pytest.mark.parametrize("slide", [0.0, 0.05, 0.1, 0.15, 0.2, 0.23])
def test_only_motions_that_the_path_makes_are_held_back_and_none_gains(arm, slide: float) -> None:
    joints = {**HOME, "slide": slide}
    space = FreeSpace.from_occupied(GRID, nothing_in(GRID) | WALL).without(arm, joints)
    before = check_motions(space, arm, joints, MOTIONS)
    rest = rest_of(sliding(-slide / 0.2), joints)
    path = check_rest(space, arm, joints, rest, FULL)
    after = with_path(before, path, rest)
    for was, now in zip(before, after, strict=True):
        assert now.level.rank <= was.level.rank and now.free_travel <= was.free_travel
        if (now.motion.joint, now.motion.direction) != ("slide", 1):
            assert now is was
    made = after[0]
    assert made.level.rank <= path.level.rank
    if path.level is Level.STOP:
        assert made.free_travel == 0 and made.cause is Cause.SURFACE and made.place_in_world is not None


def test_a_path_meets_the_wall_when_the_hand_gets_there(arm) -> None:
    space = FreeSpace.from_occupied(GRID, nothing_in(GRID) | WALL).without(arm, HOME)
    path = check_rest(space, arm, HOME, rest_of(sliding(0.0), HOME), FULL)
    assert path.looked_until_s == pytest.approx(HORIZON_S)
    truth_s = (0.951 - 0.69) / 0.2
    assert path.first is not None and 0.5 < path.first.time_s <= truth_s + 0.05
    levels = []
    for slide in np.linspace(0.0, 0.24, 13):
        joints = {**HOME, "slide": float(slide)}
        rest = rest_of(sliding(-slide / 0.2), joints)
        levels.append(check_rest(space, arm, joints, rest, FULL).level.rank)
    assert levels == sorted(levels, reverse=True) and levels[-1] == Level.STOP.rank


@given(st.floats(0.0, 3.0), st.floats(0.01, 1.0), st.floats(0.0, 3.0))
def test_a_path_is_slowed_by_the_stops_that_are_left_before_one_has_to_be_commanded(begin_s, stop_s, left_s):
    path = sliding(begin_s, seconds=9.0)
    follow_s = begin_s + left_s
    verdict = PathVerdict(path, Level.DECELERATE, None, None, follow_s, follow_s + stop_s, 9.0)
    assert share_of(verdict) == pytest.approx(min(1.0, left_s / stop_s), rel=1e-6, abs=1e-6)
    assert (
        share_of(replace(verdict, level=Level.INFORM)) == share_of(replace(verdict, level=Level.CLEAR)) == 1
    )
    assert share_of(replace(verdict, level=Level.STOP)) == 0
    assert share_of(replace(verdict, rests_by_s=follow_s)) == 0


def test_before_a_wall_the_motion_that_the_path_makes_is_slowed_more_and_more(arm) -> None:
    levels, speeds = [], []
    for slide in np.linspace(-0.3, 0.24, 28):
        joints = {**HOME, "slide": float(slide)}
        space = FreeSpace.from_occupied(GRID, nothing_in(GRID) | WALL).without(arm, joints)
        path = check_rest(space, arm, joints, rest_of(sliding_from(float(slide)), joints), FULL)
        (was,) = check_motions(space, arm, joints, MOTIONS[:1])
        (now,) = with_path(
            [replace(was, level=Level.CLEAR, free_travel=9.0)], path, rest_of(sliding_from(0), HOME)
        )
        braking = now.motion.braking_distance
        levels.append(path.level)
        speeds.append(now.free_travel / braking)
        due = {Level.STOP: 0, Level.DECELERATE: 1 + share_of(path), Level.INFORM: 5, Level.CLEAR: 9 / braking}
        assert speeds[-1] == pytest.approx(due[path.level])
    assert {Level.STOP, Level.DECELERATE, Level.INFORM} <= set(levels)
    assert speeds == sorted(speeds, reverse=True)


def sliding_from(slide: float) -> Trajectory:
    """At full speed from where it is."""
    return Trajectory(("slide",), [0.0, (0.5 - slide) / 0.2], [[slide], [0.5]])
