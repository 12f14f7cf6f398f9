"""Levenberg and Marquardt's method for whatever a step can move: residuals and rows in, state and covariance out.

Rows are derivatives of the residuals by a step. A step solves (A + damping diag A) step = -rows^T W residuals with
A = rows^T W rows. Robust weights W hold while a step is tried and are renewed once it is taken (iteratively reweighted
least squares: Holland, Welsch 1977). scipy.optimize.least_squares moves vectors only; poses are no vectors.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
State = TypeVar("State")
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-4, 1e-9, 1e8
FACTOR = 10.0
"""Damping falls by this after a step that was taken, and grows by it after one that was not."""


class Look(NamedTuple):
    """A least squares seen from one state.

    Fields:
        residuals: in sigmas, shape (m,).
        rows: gives their derivatives by a step, shape (m, n), as an array or a sparse one of scipy.
    """

    residuals: Array
    rows: Callable[[], Any]


@dataclass(frozen=True, slots=True, eq=False)
class Solution(Generic[State]):
    """Where a least squares came to rest.

    Args:
        state: there.
        residuals: in sigmas, shape (m,), without weights.
        weight: of each residual, 0 to 1, shape (m,).
        normal: rows^T W rows, shape (n, n).
    """

    state: State
    residuals: Array
    weight: Array
    normal: Array

    @property
    def cost(self) -> float:
        """Weighted sum of squares."""
        return _cost(self.residuals, self.weight)


def solved(
    look: Callable[[State], Look | None],
    moved: Callable[[State, Array], State],
    start: State,
    weigh: Callable[[Array], Array] = np.ones_like,
    *,
    steps: int = 40,
    enough: float = 1e-7,
) -> Solution[State]:
    """The state of least squares near a start.

    Args:
        look: residuals and rows at a state; None: no such state is allowed, as where a point is behind a camera. The
            start is.
        moved: a state after a step, shape (n,).
        start: where to begin.
        weigh: weight of each residual by all residuals, shape (m,) to (m,); none: all count 1.
        steps: tried at most.
        enough: a step that gains less than this share of the cost is the last one.

    Raises:
        ValueError: the start is not allowed.
    """
    state, here, damping = start, look(start), FIRST_DAMPING
    if here is None:
        raise ValueError("least squares: the start is no allowed state")
    weight = weigh(here.residuals)
    normal, gradient = equations(here, weight)
    for _ in range(steps):
        cost = _cost(here.residuals, weight)
        damped = normal + damping * np.diag(np.diag(normal) + 1e-12)
        tried = moved(state, np.asarray(-np.linalg.solve(damped, gradient), dtype=np.float64))
        there = look(tried)
        # at the bottom rounding decides which of two costs is less
        if there is None or not _cost(there.residuals, weight) <= cost * (1 + 1e-9) + 1e-18:
            damping = max(damping * FACTOR, 10 * FIRST_DAMPING)
            if damping > MOST_DAMPING:
                break
            continue
        gain = cost - _cost(there.residuals, weight)
        state, here, damping = tried, there, max(damping / FACTOR, LEAST_DAMPING)
        weight = weigh(here.residuals)
        normal, gradient = equations(here, weight)
        if gain < enough * cost + 1e-15:
            break
    return Solution(state, here.residuals, weight, normal)


def equations(look: Look, weight: Array | float = 1.0) -> tuple[Array, Array]:
    """Normal matrix and gradient.

    Args:
        look: residuals and rows.
        weight: of each residual, shape (m,).

    Returns:
        rows^T W rows, shape (n, n); rows^T W residuals, shape (n,).
    """
    root = np.sqrt(np.broadcast_to(weight, look.residuals.shape))
    rows = look.rows()
    rows = rows * root[:, None] if isinstance(rows, np.ndarray) else rows.multiply(root[:, None]).tocsr()
    normal = rows.T @ rows
    return (
        normal if isinstance(normal, np.ndarray) else normal.toarray(),
        np.asarray(rows.T @ (root * look.residuals), dtype=np.float64),
    )


def covariance(normal: Array) -> Array:
    """The inverse of a normal matrix, scaled before, so that metres and radians go together."""
    scale = 1 / np.sqrt(np.diag(normal))
    inverse = np.linalg.inv(normal * np.outer(scale, scale))
    return np.asarray((inverse + inverse.T) / 2 * np.outer(scale, scale))


def huber(size: Array, reach: float) -> Array:
    """Huber's weights: what is farther off than `reach` pulls no more than that.

    Args:
        size: how far off, in sigmas, not below 0, any shape.
        reach: in sigmas.
    """
    return np.asarray(np.minimum(1.0, reach / np.maximum(size, 1e-12)))


def _cost(residuals: Array, weight: Array) -> float:
    return float((weight * residuals) @ residuals)
