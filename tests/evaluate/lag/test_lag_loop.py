"""The closed loop: a machine that obeys, people who do not walk into it, and exact geometry beside."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.evaluate.lag.drive import SHARES, Drive
from elbowroom.evaluate.lag.lag import lag_summary, parts_of
from elbowroom.evaluate.lag.loop import PASS_TICKS, TICK_S, Setting, run_loop
from elbowroom.evaluate.lag.moves import Move, Moves, find_moves
from elbowroom.evaluate.lag.near import LinkBoxes
from elbowroom.evaluate.lag.people import SPARE_M, People
from elbowroom.geometry import VoxelGrid
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.motion import Level, Motion
from elbowroom.simulate import InterventionRoom, true_occupancy
from elbowroom.simulate.rounds import walking_staff

C_ARM = ceiling_c_arm()
HOME = dict.fromkeys(C_ARM.joint_names, 0.0)
LEVELS = st.lists(st.sampled_from(list(Level)), min_size=5, max_size=60)


def a_drive(target=0.4):
    moves = Moves([HOME, {**HOME, "larm": target}], [Move(0, 1, "larm"), Move(1, 0, "larm")])
    motions = {("larm", way): Motion("larm", way, 0.05) for way in (1, -1)}
    return Drive(moves, motions, {"larm": 0.2}, np.random.default_rng(0))


@settings(max_examples=40)
@given(LEVELS)
def test_a_machine_is_never_faster_than_it_may_be_and_brakes_within_its_braking_distance(levels):
    drive, step = a_drive(), 0.02
    for level in levels:
        before, share = drive.joints["larm"], drive.share
        drive.step(level, step)
        assert abs(drive.joints["larm"] - before) <= 0.2 * step + 1e-12
        # from full speed to rest in half a second, and up again as slowly
        assert drive.share <= max(SHARES[level], share - step / 0.5) + 1e-12 or drive.share <= share
        assert drive.share <= share + step / 0.5 + 1e-12
    here = drive.joints["larm"]
    for _ in range(40):
        drive.step(Level.STOP, step)
    assert drive.share == 0 and abs(drive.joints["larm"] - here) <= 0.05 + 0.2 * step


def test_a_machine_arrives_and_goes_back():
    drive = a_drive()
    seen = []
    for _ in range(400):
        drive.step(Level.CLEAR, 0.02)
        seen.append(drive.joints["larm"])
    assert max(seen) == pytest.approx(0.4) and seen[-1] < 0.39
    assert min(seen[100:]) >= 0


def test_a_machine_that_is_stopped_for_long_turns_back():
    drive = a_drive()
    for _ in range(50):
        drive.step(Level.CLEAR, 0.02)
    assert drive.motion.direction == 1
    for _ in range(90):
        drive.step(Level.STOP, 0.02)
    assert drive.motion.direction == -1


def test_moves_touch_no_furniture_and_lead_there_and_back():
    moves = find_moves(C_ARM, 5, np.random.default_rng(3))
    assert len(moves.moves) == 10 and len(moves.poses) == 6
    room = InterventionRoom(staff=())
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.06)
    for move in moves.moves:
        assert Move(move.end, move.start, move.joint) in moves.moves
        changed = {n for n in C_ARM.joint_names if moves.poses[move.start][n] != moves.poses[move.end][n]}
        assert changed == {move.joint}
    for pose in moves.poses:
        truth = true_occupancy(grid, room.at(0.0, joints=pose))
        assert (truth.occupied & truth.machine).sum() == 0


def test_people_wait_before_the_machine_and_turn_back_in_the_end():
    pytest.importorskip("coal", reason="coal is not installed; exact distance is left out")
    from elbowroom.evaluate.rooms.exact import ExactTravel

    staff = walking_staff()[1:2]
    # right across the lane of one who walks
    joints = {**HOME, "larm": -0.9, "propeller": 0.5}
    people, room = People(staff, C_ARM, np.random.default_rng(1)), InterventionRoom(staff=staff)
    least, places = np.inf, []
    for _ in range(300):
        people.step(joints, TICK_S)
        moment = room.at(0.0, joints=joints, people=people.stances)
        bodies = [s for s in moment.moving_solids if s.name == staff[0].name]
        least = min(least, ExactTravel(C_ARM, bodies).gap(joints, 0.2))
        places.append(people.stances[0].x_m)
    assert least >= SPARE_M - 1e-9
    assert np.ptp(places) > 0.3


def test_who_is_far_from_the_boxes_of_links_is_far_from_links():
    boxes = LinkBoxes.of(C_ARM)
    staff = walking_staff()
    bodies = [solid for person in staff for solid in person.solids(person.walk.at(0.0))]
    near = boxes.may_be_near(HOME, bodies, 0.05)
    assert len(near) < len(bodies) and boxes.may_be_near(HOME, bodies, 5.0) == bodies


def test_the_loop_runs_and_its_decisions_hold_until_the_next():
    pytest.importorskip("coal", reason="coal is not installed; exact distance is left out")
    setting = Setting(skew_ms=67.0, cameras=5, size=(32, 24), voxel_size_m=0.2)
    moves = find_moves(C_ARM, 2, np.random.default_rng(1))
    ticks = list(run_loop(setting, moves, 1.0, 1))
    assert len(ticks) == 30 and setting.reaction_ticks == 8
    assert not ticks[0].levels and len(ticks[2].levels) == 8
    for one, other in itertools.pairwise(ticks[2:]):
        if (round(other.time_s / TICK_S) - 2) % PASS_TICKS:
            assert one.levels == other.levels
    assert {type(tick.gap_m) for tick in ticks} == {float}


def test_a_summary_adds_up_parts():
    part = {
        **dict.fromkeys(("skew_ms", "voxel_size_m", "cameras", "width", "height", "people_speed_m_s"), 1),
        "which": "every motion",
        "ahead": False,
        "reaction_ms": 167.0,
        "seconds": 60.0,
        "moving_s": 40.0,
        "touched": 0,
        "windows": 3,
        "missed": 1,
        "stopped_before": 1,
        "never_stopped": 1,
        "needless": 4,
        "needless_pct": 10.0,
        "stopped_pct": 20.0,
        "least_gap_mm": 31.0,
    }
    (row,) = lag_summary(
        [{**part, "lags_ms": [33.0]}, {**part, "lags_ms": [], "seconds": 30.0, "least_gap_mm": None}]
    )
    assert (row["windows"], row["missed"], row["late"], row["lag_worst_ms"]) == (6, 2, 1, 33.0)
    assert (
        row["minutes"] == 1.5 and row["needless_pct"] == pytest.approx(10.0) and row["least_gap_mm"] == 31.0
    )
    assert parts_of(5) == 2 and parts_of(0.1) == 1
