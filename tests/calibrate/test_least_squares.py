"""Least squares: beside the plain solution, on what is no vector, past what is far off, around what is not allowed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares as by_scipy
from scipy.sparse import csr_array

from elbowroom.calibrate.least_squares import Look, covariance, equations, huber, solved
from elbowroom.geometry.twist import between, cross_matrix, exp, moved

SEEDS = st.integers(0, 2**32 - 1)


def line(seed, count=40):
    """Rows and values of a line with noise of sigma one, every eighth value far off."""
    random = np.random.default_rng(seed)
    rows = np.column_stack([random.uniform(-5, 5, count), np.ones(count)])
    values = rows @ [2.0, -1.0] + random.normal(0, 1, count)
    return rows, values


def look_at(rows, values):
    return lambda state: Look(rows @ state - values, lambda: rows)


@given(SEEDS)
@settings(max_examples=30)
def test_a_linear_problem_is_solved_as_by_normal_equations(seed):
    rows, values = line(seed)
    best = solved(look_at(rows, values), np.add, np.zeros(2), enough=1e-14)
    np.testing.assert_allclose(best.state, np.linalg.lstsq(rows, values, rcond=None)[0], atol=1e-7)
    np.testing.assert_allclose(covariance(best.normal), np.linalg.inv(rows.T @ rows), rtol=1e-9)
    assert best.cost == pytest.approx(((rows @ best.state - values) ** 2).sum())


@given(SEEDS)
@settings(max_examples=30)
def test_sparse_rows_say_the_same(seed):
    rows, values = line(seed)
    weight = np.random.default_rng(seed).uniform(0, 1, len(values))
    look = Look(rows @ [1.0, 1.0] - values, lambda: rows)
    for one, other in zip(
        equations(look, weight), equations(look._replace(rows=lambda: csr_array(rows)), weight), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-10, atol=1e-10)


@given(SEEDS)
@settings(max_examples=30)
def test_with_hubers_weights_it_is_the_least_of_hubers_loss(seed):
    rows, values = line(seed)
    values[::8] += 30.0
    best = solved(
        look_at(rows, values), np.add, np.zeros(2), lambda off: huber(np.abs(off), 2.0), steps=200, enough=0.0
    )
    other = by_scipy(lambda x: rows @ x - values, np.zeros(2), loss="huber", f_scale=2.0, xtol=1e-12)
    np.testing.assert_allclose(best.state, other.x, atol=1e-4)
    assert (best.weight[::8] < 0.2).all()


@given(SEEDS)
@settings(max_examples=30)
def test_a_pose_is_found_from_points(seed):
    random = np.random.default_rng(seed)
    points, truth = random.uniform(-1, 1, (8, 3)), exp(random.uniform(-0.8, 0.8, 6))
    seen = points @ truth[:3, :3].T + truth[:3, 3]

    def look(pose):
        turn = pose[:3, :3]
        rows = np.concatenate([-turn @ cross_matrix(points), np.broadcast_to(turn, (8, 3, 3))], axis=2)
        return Look((points @ turn.T + pose[:3, 3] - seen).ravel(), lambda: rows.reshape(-1, 6))

    best = solved(look, moved, np.eye(4), enough=1e-12)
    assert np.abs(between(best.state, truth)).max() < 1e-6


def test_what_is_not_allowed_is_gone_around():
    def look(x):
        return None if x[0] <= 0 else Look(np.log(x) - 1.0, lambda: np.diag(1 / x))

    assert solved(look, np.add, np.array([20.0])).state[0] == pytest.approx(np.e, rel=1e-4)
    with pytest.raises(ValueError, match="no allowed state"):
        solved(look, np.add, np.array([-1.0]))


def test_a_cost_that_is_no_number_is_not_taken():
    def look(x):
        with np.errstate(invalid="ignore"):
            return Look(np.sqrt(x) - 2.0, lambda: np.diag(0.5 / np.sqrt(x)))

    best = solved(look, np.add, np.array([100.0]))
    assert best.state[0] == pytest.approx(4.0, rel=1e-3)
