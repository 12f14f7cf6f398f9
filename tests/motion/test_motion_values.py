import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import InputError, MachineError
from elbowroom.motion import Cause, JointPath, Level, Motion, Verdict, braking_distance, most_cautious

NOT_A_DISTANCE = (0.0, -0.1, math.nan, math.inf)


def verdict_of(free_travel, cause=Cause.SURFACE, braking=0.1):
    motion = Motion("larm", 1, braking)
    return Verdict(
        motion, Level.at(free_travel, braking), free_travel, "rad", "l_arm", (0.0, 0.0, 1.0), cause
    )


verdicts = st.builds(
    verdict_of,
    st.floats(0, 0.6),
    st.sampled_from([Cause.SURFACE, Cause.BLIND, Cause.UNSEEN, Cause.OUTSIDE_GRID]),
    st.sampled_from([0.05, 0.1]),
)


def test_braking_at_constant_deceleration_takes_half_the_way_of_full_speed():
    assert braking_distance(0.15, 0.5) == pytest.approx(0.0375)


@pytest.mark.parametrize("value", NOT_A_DISTANCE)
def test_braking_from_an_impossible_speed_or_time_is_refused(value):
    with pytest.raises(InputError, match="speed"):
        braking_distance(value, 0.5)
    with pytest.raises(InputError, match="braking_time_s"):
        braking_distance(0.15, value)


@pytest.mark.parametrize("direction", (0, 2, -2, 0.5, math.nan, True))
def test_a_direction_is_plus_or_minus_one(direction):
    with pytest.raises(InputError, match=r"direction is .*must be"):
        Motion("larm", direction, 0.1)


@pytest.mark.parametrize("value", NOT_A_DISTANCE)
def test_distances_of_motions_and_paths_are_finite_and_above_zero(value):
    for build in (
        lambda **more: Motion("larm", 1, **more),
        lambda **more: JointPath([{"larm": 1.0}], **more),
    ):
        with pytest.raises(InputError, match="braking_distance"):
            build(braking_distance=value)
        with pytest.raises(InputError, match="reach"):
            build(braking_distance=0.1, reach=value)


def test_a_motion_is_looked_at_for_five_braking_distances_unless_told():
    assert Motion("larm", 1, 0.1).looked_at == pytest.approx(0.5)
    assert Motion("larm", 1, 0.1, reach=0.2).looked_at == 0.2


def test_a_path_without_waypoints_or_with_nan_is_refused():
    with pytest.raises(InputError, match="no waypoints"):
        JointPath([], 0.1)
    with pytest.raises(MachineError, match="waypoint 1: joint carc is nan"):
        JointPath([{"carc": 0.0}, {"carc": math.nan}], 0.1)


@pytest.mark.parametrize(
    ("travel", "level", "band"),
    [
        (0.0, Level.STOP, "S"),
        (0.125, Level.STOP, "S"),
        (0.126, Level.DECELERATE, "M"),
        (0.25, Level.DECELERATE, "M"),
        (0.26, Level.INFORM, "L"),
        (0.625, Level.INFORM, "L"),
        (0.63, Level.CLEAR, "0"),
        (math.nan, Level.STOP, "S"),
    ],
)
def test_levels_end_at_one_two_and_five_braking_distances(travel, level, band):
    assert Level.at(travel, 0.125) is level
    assert level.band == band


def test_only_unseen_space_may_be_overridden():
    assert [cause for cause in Cause if verdict_of(0.1, cause).overridable] == [Cause.UNSEEN]


def test_a_fault_wins_over_all_then_what_is_too_old_then_input_that_cannot_be_right_then_the_watch():
    motion = Motion("larm", 1, 0.1)
    at_once = verdict_of(0.0)
    watch, wrong, stale, fault = (
        Verdict.stop(motion, "rad", cause) for cause in (Cause.WATCH, Cause.INPUT, Cause.STALE, Cause.FAULT)
    )
    assert most_cautious([at_once, watch, wrong, fault]) is fault
    assert most_cautious([at_once, watch, wrong, stale]) is stale
    assert most_cautious([at_once, watch, wrong]) is wrong
    assert most_cautious([at_once, watch, verdict_of(0.0, Cause.BLIND)]) is watch
    assert (fault.level, fault.free_travel, fault.overridable) == (Level.STOP, 0.0, False)


def test_a_row_says_joint_and_direction_of_a_motion_and_the_name_of_a_path():
    verdict = verdict_of(0.15)
    row = verdict.row()
    assert (row["joint"], row["direction"], row["level"], row["band"]) == ("larm", "+", "decelerate", "M")
    assert (row["cause"], row["braking_distance"], row["place_m"]) == ("surface", 0.1, (0.0, 0.0, 1.0))
    path = JointPath([{"larm": 0.0}, {"larm": 0.1}], 0.1)
    row = replace(verdict, motion=path).row()
    assert (row["joint"], row["direction"], row["braking_distance"]) == (path.name, None, 0.1)


def test_no_verdicts_are_an_error_and_never_clear():
    with pytest.raises(InputError, match="no verdicts"):
        most_cautious([])


@given(st.lists(verdicts, min_size=1, max_size=6), st.randoms())
def test_the_most_cautious_verdict_wins_in_any_order(some, random):
    winner = most_cautious(some)
    assert winner.level.rank == min(verdict.level.rank for verdict in some)
    rivals = [verdict for verdict in some if verdict.level is winner.level]
    if winner.overridable:
        assert all(rival.overridable for rival in rivals)
    shuffled = random.sample(some, len(some))
    again = most_cautious(shuffled)
    assert (again.level, again.overridable) == (winner.level, winner.overridable)
    assert (
        again.free_travel / again.motion.braking_distance
        == winner.free_travel / winner.motion.braking_distance
    )
