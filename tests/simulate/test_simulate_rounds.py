"""People on their feet: closed rounds at walking speed, past everything."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.simulate import InterventionRoom, true_occupancy
from elbowroom.simulate.person import STRIDE_M
from elbowroom.simulate.rounds import ALONG_M_S2, SIDEWAYS_M_S2, Rounds, walking_staff

SQUARE = ((0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0))


def places(rounds, times):
    return np.array([(stance.x_m, stance.y_m) for stance in map(rounds.at, times)])


@settings(max_examples=20)
@given(st.floats(0.3, 2.0), st.floats(0.05, 0.9), st.floats(0, 1), st.booleans())
def test_a_round_is_closed_and_nobody_runs_or_jerks(speed, radius, start, turned):
    rounds = Rounds(SQUARE[::-1] if turned else SQUARE, speed, radius, start)
    here, later = rounds.at(1.0), rounds.at(1.0 + rounds.period_s)
    assert (later.x_m, later.y_m) == pytest.approx((here.x_m, here.y_m), abs=1e-6)
    step = 0.02
    speeds = (
        np.linalg.norm(np.diff(places(rounds, np.arange(0, rounds.period_s, step)), axis=0), axis=1) / step
    )
    assert speeds.max() <= speed + 1e-6
    assert np.abs(np.diff(speeds)).max() / step <= 2 * (ALONG_M_S2 + SIDEWAYS_M_S2)


def test_who_walks_looks_ahead_and_swings_arms_with_the_way():
    rounds = Rounds(SQUARE, 1.4)
    times = np.arange(0.5, 8, 0.31)
    for here, ahead in ((rounds.at(t), rounds.at(t + 1e-3)) for t in times):
        way = np.array([ahead.x_m - here.x_m, ahead.y_m - here.y_m])
        assert way @ (np.cos(here.heading_rad), np.sin(here.heading_rad)) == pytest.approx(
            np.linalg.norm(way), rel=1e-2
        )
        assert (ahead.phase - here.phase) * STRIDE_M / (2 * np.pi) == pytest.approx(
            np.linalg.norm(way), rel=2e-2
        )


def test_the_staff_walk_at_1_2_to_1_6_m_s_and_slow_down_in_corners():
    for person in walking_staff():
        times = np.arange(0, person.walk.period_s, 0.02)
        speeds = np.linalg.norm(np.diff(places(person.walk, times), axis=0), axis=1) / 0.02
        assert 1.2 <= speeds.max() <= 1.601
        assert speeds.min() > 0.5


def test_the_staff_touch_neither_furniture_nor_the_machine_on_its_course_nor_each_other():
    grid = VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.04)
    staff = walking_staff()
    taken = true_occupancy(grid, InterventionRoom(staff=()).at(0.0)).occupied
    for time_s in np.arange(0, 120, 4.0):
        taken |= true_occupancy(grid, InterventionRoom(staff=(), furniture=False).at(time_s)).machine
    for time_s in np.arange(0, 24, 0.43):
        moment = InterventionRoom(furniture=False, staff=staff).at(time_s)
        assert not (true_occupancy(grid, moment).occupied & taken).any(), time_s
        bodies = [s.vertices_in_world for s in moment.moving_solids if s.name in {p.name for p in staff}]
        for number, mine in enumerate(bodies):
            assert mine[:, 2].min() >= 0 and np.abs(mine[:, :2]).max() < 2
            for other in bodies[number + 1 :]:
                apart = np.maximum(mine.min(axis=0) - other.max(axis=0), other.min(axis=0) - mine.max(axis=0))
                assert apart.max() > 0.05, time_s


@pytest.mark.parametrize("wrong", [{"corners_m": SQUARE[:2]}, {"speed_m_s": 0.0}, {"radius_m": -1.0}])
def test_rounds_that_cannot_be_walked_are_refused(wrong):
    with pytest.raises(InputError, match="rounds"):
        Rounds(**{"corners_m": SQUARE, **wrong})
