"""What views scatter by, estimated from how they disagree: restricted maximum likelihood, component by component.

A view's nine numbers y have the variance

    V = diag(corner ... corner, plane ... plane) + K diag(turn^2, shift^2) K^T + depth^2 b b^T

*corner* and *plane*: factors of a camera's own sigmas. *turn*, *shift*: by how much the board seems to be elsewhere in
one view than in another: a hand that shakes between exposures, errors that all corners of an image share; K is how y
changes by a motion of the board. *depth*: an offset that all depth points of one image share; b is how y changes by it.

Each component s is renewed by s <- s (y^T P V_s P y) / tr(P V_s), P = W - W X C X^T W, W = V^-1, X the rows and C the
covariance of the unknowns (Searle, Casella, McCulloch: Variance Components, 1992, ch. 8). Components of which the views
say little stay near where they begin.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
START = {"corner": 1.5, "plane": 1.5, "turn": 2e-4**2, "shift": 3e-4**2, "depth": 1e-3**2}
"""Before views are compared: factors, and squares of [rad], [m], [m]."""
START_FREEDOM = 4.0
"""Degrees of freedom that the start weighs."""
LEAST = {"corner": 1e-2, "plane": 1e-3, "turn": 1e-7**2, "shift": 1e-7**2, "depth": 1e-7**2}
SHRINKAGE = 40.0
"""Degrees of freedom that the factor of all cameras weighs against a camera's own."""
OUTLYING = 4.0
"""A view is weighted down if its chi-square is more than so many times its nine numbers."""


@dataclass(frozen=True, slots=True, eq=False)
class ViewRows:
    """A view at one linearisation.

    Args:
        camera: its name.
        among: where the columns stand among all unknowns, shape (k,).
        rows: derivatives of y, shape (n, k), n is 6 or 9.
        y: residuals, shape (n,): six of the corners, then three of the plane.
        by_motion: K, shape (n, 6).
        by_depth: b, shape (n,).
    """

    camera: str
    among: NDArray[np.int64]
    rows: Array
    y: Array
    by_motion: Array
    by_depth: Array


@dataclass(frozen=True, slots=True, eq=False)
class Variances:
    """The components.

    Args:
        corner, plane: factors by camera.
        turn, shift, depth: variances [rad^2], [m^2], [m^2].
        start: of the corners' factor, for cameras of which views say little.
        view: weight of each view, 0 to 1, shape (n,).
    """

    corner: Mapping[str, float]
    plane: Mapping[str, float]
    turn: float
    shift: float
    depth: float
    start: float
    view: Array = field(repr=False)

    @classmethod
    def before(cls, cameras: Sequence[str], views: int, within: float) -> "Variances":
        """Before views are compared.

        Args:
            cameras: names.
            views: how many.
            within: variance of corners about the best pose of each view alone, over what their sigmas promise.
        """
        start = START["corner"] * max(1.0, within)
        return cls(
            dict.fromkeys(cameras, start),
            dict.fromkeys(cameras, START["plane"]),
            START["turn"],
            START["shift"],
            START["depth"],
            start,
            np.ones(views),
        )

    def inverse(self, view: ViewRows, weight: float) -> Array:
        """V^-1 of a view, times its weight, shape (n, n)."""
        n = len(view.y)
        plain = np.full(n, self.plane[view.camera])
        plain[:6] = self.corner[view.camera]
        motion = view.by_motion * np.sqrt([self.turn] * 3 + [self.shift] * 3)
        v = np.diag(plain) + motion @ motion.T + self.depth * np.outer(view.by_depth, view.by_depth)
        return np.asarray(weight * np.linalg.inv(v))

    def renewed(
        self, views: Sequence[ViewRows], off: Sequence[Array], covariance: Array, robust: bool
    ) -> "Variances":
        """The components after one step.

        Args:
            views: rows.
            off: y of each at the solution.
            covariance: of all unknowns, with these variances.
            robust: whether views are weighted by how badly they fit.
        """
        corner: dict[str, list[float]] = {name: [0.0, 0.0] for name in self.corner}
        plane: dict[str, list[float]] = {name: [0.0, 0.0] for name in self.plane}
        shared = {"turn": [0.0, 0.0], "shift": [0.0, 0.0], "depth": [0.0, 0.0]}
        weights = np.ones(len(views))
        for number, (view, y) in enumerate(zip(views, off, strict=True)):
            weight = float(self.view[number])
            inverse = self.inverse(view, weight)
            pulled = inverse @ y
            used = inverse @ view.rows
            projected = inverse - used @ covariance[np.ix_(view.among, view.among)] @ used.T
            motion, depth = view.by_motion, view.by_depth
            pulls, stiff = motion.T @ pulled, np.einsum("ik,ij,jk->k", motion, projected, motion)
            for sums, variance, square, freedom in (
                (
                    corner[view.camera],
                    self.corner[view.camera],
                    pulled[:6] @ pulled[:6],
                    np.trace(projected[:6, :6]),
                ),
                (
                    plane[view.camera],
                    self.plane[view.camera],
                    pulled[6:] @ pulled[6:],
                    np.trace(projected[6:, 6:]),
                ),
                (shared["turn"], self.turn, pulls[:3] @ pulls[:3], stiff[:3].sum()),
                (shared["shift"], self.shift, pulls[3:] @ pulls[3:], stiff[3:].sum()),
                (shared["depth"], self.depth, (depth @ pulled) ** 2, depth @ projected @ depth),
            ):
                # a view that counts half has twice the variance
                sums[0] += variance**2 * float(square) / weight
                sums[1] += variance * max(float(freedom), 0.0) / weight
            if robust:
                ratio = float(y @ pulled) / weight / len(y)
                weights[number] = min(1.0, OUTLYING / max(ratio, 1e-12))
        turn, shift, depth_ = (
            max(
                (START_FREEDOM * START[name] + shared[name][0]) / (START_FREEDOM + shared[name][1]),
                LEAST[name],
            )
            for name in ("turn", "shift", "depth")
        )
        return Variances(
            _factors(corner, self.start, LEAST["corner"]),
            _factors(plane, START["plane"], LEAST["plane"]),
            turn,
            shift,
            depth_,
            self.start,
            weights,
        )

    def change(self, other: "Variances") -> float:
        """The greatest relative change of a component that matters."""
        pairs = [(self.turn, other.turn), (self.shift, other.shift), (self.depth, other.depth)]
        pairs += [(self.corner[name], other.corner[name]) for name in self.corner]
        pairs += [(self.plane[name], other.plane[name]) for name in self.plane]
        return float(max(abs(np.log(one / two)) for one, two in pairs))


def _factors(sums: Mapping[str, Sequence[float]], start: float, least: float) -> dict[str, float]:
    """A factor for each camera: its own, drawn towards that of all, which is drawn towards the start."""
    squares, freedom = sum(s for s, _ in sums.values()), sum(f for _, f in sums.values())
    shared = (START_FREEDOM * start + squares) / (START_FREEDOM + freedom)
    return {camera: max((SHRINKAGE * shared + s) / (SHRINKAGE + f), least) for camera, (s, f) in sums.items()}
