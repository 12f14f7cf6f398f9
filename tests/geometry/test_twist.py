"""Small motions: exponential, logarithm, and how they go from frame to frame."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from elbowroom.geometry import invert_rigid
from elbowroom.geometry.twist import adjoint, between, cross_matrix, exp, log, moved, sizes

TWISTS = st.lists(st.floats(-1.7, 1.7), min_size=6, max_size=6).map(np.array)


@given(TWISTS)
@settings(max_examples=60)
def test_log_undoes_exp(twist):
    np.testing.assert_allclose(log(exp(twist)), twist, atol=1e-8)
    np.testing.assert_allclose(exp(twist) @ exp(-twist), np.eye(4), atol=1e-9)


@given(TWISTS, TWISTS)
@settings(max_examples=60)
def test_between_is_what_moved(pose, twist):
    pose = exp(pose)
    np.testing.assert_allclose(between(pose, moved(pose, twist)), twist, atol=1e-8)


@given(TWISTS, TWISTS)
@settings(max_examples=60)
def test_adjoint_brings_a_motion_to_another_frame(pose, twist):
    to_from_frame = exp(pose)
    same = to_from_frame @ exp(twist) @ invert_rigid(to_from_frame)
    np.testing.assert_allclose(exp(adjoint(to_from_frame) @ twist), same, atol=1e-8)


def test_sizes_are_metres_and_radians():
    assert sizes(np.array([0.0, 0.3, 0.4, 2.0, 0.0, 0.0])) == (2.0, 0.5)


def test_cross_matrix_is_the_cross_product():
    a, b = np.random.default_rng(0).normal(0, 1, (2, 5, 3))
    np.testing.assert_allclose((cross_matrix(a) @ b[:, :, None])[:, :, 0], np.cross(a, b))
