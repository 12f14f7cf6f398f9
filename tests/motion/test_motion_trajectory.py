import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from elbowroom.errors import JointsError
from elbowroom.motion import MachineState, Trajectory
from elbowroom.motion.trajectory import STRAIGHT

TWO = ("slide", "turn")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (((), [0], [[]]), "at least one"),
        ((("a", "a"), [0], [[0, 0]]), "each once"),
        ((TWO, [], np.zeros((0, 2))), "no points"),
        ((TWO, [0, 1, 1], np.zeros((3, 2))), "strictly rise"),
        ((TWO, [0, 2, 1], np.zeros((3, 2))), "point 2 is at 1 s after one at 2 s"),
        ((TWO, [0, 1], np.zeros((2, 3))), r"shape \(2, 3\)"),
        ((TWO, [0, np.nan], np.zeros((2, 2))), "finite"),
        ((TWO, [0, 1], [[0, 0], [0, np.inf]]), "positions of point 1"),
        ((TWO, [0, 1], np.zeros((2, 2)), np.zeros((1, 2))), "velocities"),
        ((TWO, [0, 1], [["x", 0], [0, 0]]), "no table of numbers"),
        ((TWO, [0, 1], [[10**400, 0], [0, 0]]), "no table of numbers"),
    ],
)
def test_what_is_no_path_is_refused_and_said(arguments, said):
    with pytest.raises(JointsError, match=said):
        Trajectory(*arguments)


def test_velocities_that_are_not_of_these_positions_are_refused():
    path = Trajectory(("turn",), [0.0, 10.0], [[0.0], [1.0]], [[1e7], [0.0]])
    with pytest.raises(JointsError, match="go far off"):
        path.straightened()


@settings(max_examples=60)
@given(st.lists(st.tuples(*[st.floats(-2, 2)] * 4), min_size=2, max_size=6), st.floats(0.05, 2))
def test_straight_lines_stay_beside_the_cubic_curve_of_another_library(rows, step):
    rows, times = np.array(rows), step * np.arange(len(rows))
    path = Trajectory(TWO, times, rows[:, :2], rows[:, 2:])
    curve = CubicHermiteSpline(times, rows[:, :2], rows[:, 2:])
    straight = path.straightened()
    asked = np.linspace(times[0], times[-1], 500)
    found = np.stack([np.interp(asked, straight.times_s, column) for column in straight.positions.T], axis=1)
    assert np.abs(found - curve(asked)).max() <= 1.01 * STRAIGHT + 1e-12


def test_parts_of_a_path_are_where_the_path_is():
    path = Trajectory(TWO, [1.0, 2.0, 4.0], [[0, 0], [1, -1], [1, 1]])
    part = path.between(1.5, 3.0)
    assert (part.begin_s, part.end_s) == (1.5, 3.0)
    for time_s in (1.5, 1.7, 2.0, 2.5, 3.0):
        assert part.at(time_s) == pytest.approx(path.at(time_s))
    assert path.at(0.0) == path.at(1.0) and path.at(9.0) == path.at(4.0)
    assert path.end_velocities.tolist() == [0.0, 1.0]
    with pytest.raises(JointsError, match="nothing of it"):
        path.between(5.0, 6.0)


@pytest.mark.parametrize(
    ("positions", "velocities", "said"),
    [
        ({"slide": np.nan}, {}, "position of slide"),
        ({"slide": 0.0}, {"slide": np.inf}, "velocity of slide"),
        ({"slide": 0.0}, {"turn": 0.1}, "turn has a velocity and no position"),
    ],
)
def test_a_state_that_is_none_is_refused(positions, velocities, said):
    with pytest.raises(JointsError, match=said):
        MachineState(positions, velocities)
