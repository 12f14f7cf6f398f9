"""What a machine that moves is told in each pass."""

import pytest

from elbowroom.motion import (
    Braking,
    Cause,
    Level,
    MachineState,
    check_motions,
    check_moving,
    check_stop,
    joint_motions,
)
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)
TIMES = {"slide": 0.2, "turn": 0.4, "nod": 0.4}
BRAKING = Braking(dict.fromkeys(TIMES, 1.0), TIMES)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


def space_with(arm, wall):
    return FreeSpace.from_occupied(GRID, nothing_in(GRID) | wall).without(arm, HOME)


def test_two_joints_together_may_meet_what_none_meets_alone(arm):
    # a post before the hand and to its left: each joint alone passes it
    post = touched_by_box(GRID, (0.701, 0.151, 0.45), (0.749, 0.199, 0.75))
    space, motions = space_with(arm, post), joint_motions(arm, BRAKING.speeds, BRAKING.times_s)
    alone = {v.motion.name: v for v in check_motions(space, arm, HOME, motions)}
    assert {alone["slide +"].level, alone["turn +"].level} == {Level.CLEAR, Level.INFORM} or all(
        alone[name].level is not Level.STOP for name in ("slide +", "turn +")
    )
    state = MachineState(HOME, {"slide": 0.9, "turn": 0.9, "nod": 0.0})
    verdicts, stop = check_moving(space, arm, state, motions, BRAKING)
    assert not stop.is_free and stop.first.link == "hand"
    after = {v.motion.name: v for v in verdicts}
    for name in ("slide +", "turn +"):
        assert (after[name].level, after[name].cause, after[name].safe_speed) == (
            Level.STOP,
            Cause.SURFACE,
            0.0,
        )
    for name in ("slide -", "turn -", "nod +", "nod -"):
        assert after[name] == alone[name]


def test_a_machine_that_stands_is_told_the_same_as_without_velocities(arm):
    wall = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    space, motions = space_with(arm, wall), joint_motions(arm, BRAKING.speeds, BRAKING.times_s)
    verdicts, stop = check_moving(space, arm, MachineState(HOME, dict.fromkeys(HOME, 0.0)), motions, BRAKING)
    assert verdicts == check_motions(space, arm, HOME, motions)
    assert stop.is_free


@pytest.mark.parametrize("share", (0.3, 0.6, 0.9))
def test_a_stop_at_the_safe_speed_is_free_and_a_little_above_it_is_not(arm, share):
    # 0.26 m before the hand, less what is asked for
    wall = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    space, times = space_with(arm, wall), TIMES | {"slide": 2 * 0.25 / share}
    braking = Braking(BRAKING.speeds, times)
    verdict = check_motions(space, arm, HOME, joint_motions(arm, braking.speeds, times))[0]
    speed = verdict.safe_speed
    assert speed == pytest.approx(share, abs=0.06)
    for factor, is_free in ((0.95, True), (1.1, False)):
        state = MachineState(HOME, {"slide": min(1.0, factor * speed)})
        assert check_stop(space, arm, state, braking).is_free is is_free
