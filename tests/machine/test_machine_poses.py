"""Poses are drawn between the joints' own limits."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.machine.joint import Joint
from elbowroom.machine.poses import LONG_M, REACH, drawn_between, is_bounded, random_poses

ENDS = st.floats(-2000, 2000) | st.sampled_from([-math.inf, math.inf])


def joint(lower, upper, kind="prismatic"):
    return Joint("j", kind, "a", "b", np.array([1.0, 0, 0]), np.eye(4), lower, upper)


@given(ENDS, ENDS, st.sampled_from(["prismatic", "revolute"]))
def test_a_draw_lies_within_the_limits_and_has_all_of_them_where_they_are_sensible(one, other, kind):
    lower, upper = min(one, other), max(one, other)
    if math.inf in (lower, -upper):
        return
    made = joint(lower, upper, kind)
    low, high = drawn_between(made)
    assert lower <= low <= high <= upper and np.isfinite([low, high]).all()
    if is_bounded(made):
        assert (low, high) == (lower, upper)
    else:
        assert high - low == pytest.approx(2 * REACH)
        assert low - 1e-9 <= min(max(0.0, lower), upper) <= high + 1e-9
    drawn = random_poses([made], 50)
    assert ((drawn >= low) & (drawn <= high)).all()


@given(st.floats(-3, 0), st.floats(0, 3), st.integers(0, 5))
def test_what_lies_within_half_a_turn_is_drawn_as_ever(lower, upper, seed):
    """Poses of a seed are those of experiments that were made with it, beside whatever joint."""
    joints = [
        joint(lower, upper, "revolute"),
        joint(0, 8),
        joint(-math.inf, math.inf, "continuous"),
        joint(-math.inf, math.inf),
    ]
    as_ever = np.random.default_rng(seed).uniform(
        [lower, 0, -np.pi, -np.pi], [upper, np.pi, np.pi, np.pi], (20, 4)
    )
    drawn = random_poses(joints, 20, seed)
    assert np.array_equal(drawn[:, [0, 2, 3]], as_ever[:, [0, 2, 3]])
    assert drawn[:, 1].max() > np.pi


def test_a_slide_out_of_all_proportion_is_one_without_end():
    assert is_bounded(joint(0, LONG_M)) and not is_bounded(joint(0, LONG_M + 1))
    assert drawn_between(joint(0, 5000)) == (0, 2 * REACH)
    assert drawn_between(joint(-5000, -200)) == (-200 - 2 * REACH, -200)


def test_a_machine_without_joints_has_one_pose():
    assert random_poses([], 3).shape == (3, 0)
