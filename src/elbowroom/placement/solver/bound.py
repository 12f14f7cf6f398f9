"""What no layout of the candidates can do better: a linear relaxation that holds for all points.

Of views pairwise at least an angle A apart, an arc that leaves out j A of the circle must hold all but j: the arc left
out, open and j A long, has room for no more than j. Chosen candidates become numbers from 0 to 1, points that need not
be valid too, and of the arcs only those are written down that a solution so far violates. Points that are not written
down count as valid. So the optimum is never above the price of any layout that reaches the share.
"""

import math
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import csr_matrix, vstack

from elbowroom.placement.solver.kernels import search as kernels
from elbowroom.placement.solver.model import Model

ROUNDS = 40
VIOLATED = 1e-4
HARD_POINTS = 1200
"""For so many points arcs are written down."""
AHEAD = 2e-7
"""Arcs are longer by this, so that rounding never makes one too short [rad]."""


def hard_points(model: Model) -> NDArray[np.int64]:
    """The points that are hardest to see from all sides: some arc that must hold a view holds few places."""
    requirement = model.requirement
    if model.points <= HARD_POINTS:
        return np.arange(model.points)
    places = len(model.azimuth)
    seen = np.zeros((places, model.points), dtype=bool)
    np.logical_or.at(seen, model.place_of, model.sees > 0)
    left_out = max(requirement.views - 1, 0) * math.radians(requirement.angle_deg)
    lengths = np.array([2 * math.pi - left_out + AHEAD])
    weight, starts, sums = np.ones(places), np.zeros(1), np.zeros(1)
    fewest = np.zeros(model.points)
    for p in range(model.points):
        azimuth = model.azimuth[:, p]
        here = np.flatnonzero(seen[:, p] & ~np.isnan(azimuth))
        kernels.least_arcs(azimuth, here[np.argsort(azimuth[here])], weight, len(here), lengths, starts, sums)
        fewest[p] = sums[0]
    return np.argsort(fewest, kind="stable")[:HARD_POINTS]


class _Relaxation:
    """Rows over chosen candidates (x) and points (z): sum of x over an arc >= least * z of a point."""

    def __init__(self, model: Model, points: NDArray[np.int64]) -> None:
        self.model, self.points = model, points
        self.rows: list[csr_matrix] = []
        self.known: set[tuple[int, bytes, int]] = set()
        views = model.requirement.views
        for p in range(len(points)):
            self._add(p, model.sees[:, points[p]] > 0, views)

    def _add(self, p: int, members: NDArray[np.bool_], least: int) -> bool:
        key = (p, np.packbits(members).tobytes(), least)
        if key in self.known:
            return False
        self.known.add(key)
        columns = np.flatnonzero(members)
        data = np.concatenate([-np.ones(len(columns)), [float(least)]])
        index = np.concatenate([columns, [self.model.candidates + p]])
        shape = (1, self.model.candidates + len(self.points))
        self.rows.append(csr_matrix((data, (np.zeros(len(index), dtype=int), index)), shape=shape))
        return True

    def separate(self, x: NDArray[np.float64], z: NDArray[np.float64]) -> int:
        """Adds arcs that a solution violates; returns how many."""
        model, requirement = self.model, self.model.requirement
        angle = math.radians(requirement.angle_deg)
        lengths = np.array([2 * math.pi - j * angle for j in range(1, requirement.views)])
        if not len(lengths):
            return 0
        starts, sums = np.zeros(len(lengths)), np.zeros(len(lengths))
        added = 0
        for p in range(len(self.points)):
            if z[p] < VIOLATED:
                continue
            azimuth = model.azimuth[model.place_of, self.points[p]]
            seen = (model.sees[:, self.points[p]] > 0) & ~np.isnan(azimuth)
            here = np.flatnonzero(seen)
            order = here[np.argsort(azimuth[here])]
            kernels.least_arcs(azimuth, order, x, len(order), lengths + AHEAD, starts, sums)
            for j, (start, total) in enumerate(zip(starts, sums, strict=True)):
                least = requirement.views - 1 - j
                if total < least * z[p] - VIOLATED:
                    # a camera straight above has no direction: it may stand in any arc
                    turn = np.mod(azimuth - start, 2 * math.pi)
                    above = (model.sees[:, self.points[p]] > 0) & np.isnan(azimuth)
                    added += self._add(p, above | (seen & (turn <= lengths[j] + AHEAD)), least)
        return added


def price_bound(model: Model, share: float, until: float, stop: Callable[[], bool] = lambda: False) -> float:
    """No layout with this share of valid points costs less.

    Args:
        model: all points.
        share: wanted, 0 to 1.
        until: when to come to an end [s, time.perf_counter].
        stop: it ends as well when this says so.

    Returns:
        The bound; the price of as many cameras as views if there was no time for more.
    """
    points = hard_points(model)
    needed = max(0.0, math.ceil(share * model.points - 1e-9) - (model.points - len(points)))
    cost = np.concatenate([model.price, np.zeros(len(points))])
    cost[list(model.kept)] = 0.0
    count = csr_matrix(np.concatenate([np.zeros(model.candidates), -np.ones(len(points))]))
    # a single valid point needs as many cameras as views: that is known without solving anything
    new = np.sort(np.delete(model.price, list(model.kept)))
    fewest = float(new[: max(0, model.requirement.views - len(model.kept))].sum()) if share > 0 else 0.0
    return max(fewest, _solve(model, points, cost, count, -needed, until, stop))


def share_bound(model: Model, budget: float, until: float, stop: Callable[[], bool] = lambda: False) -> float:
    """No layout of at most this price has a greater share of valid points.

    Args:
        model: candidates and points.
        budget: greatest price of all that is new.
        until: when time is up, as `time.perf_counter` counts [s].
        stop: it ends as well when this says so.

    Returns:
        The share, 0 to 1; 1 if there was no time.
    """
    points = hard_points(model)
    price = model.price.copy()
    price[list(model.kept)] = 0.0
    cost = np.concatenate([np.zeros(model.candidates), -np.ones(len(points))])
    limit = csr_matrix(np.concatenate([price, np.zeros(len(points))]))
    least = _solve(model, points, cost, limit, budget, until, stop)
    valid = len(points) if not np.isfinite(least) else -least
    return min(1.0, (model.points - len(points) + valid + 1e-6) / model.points)


def _solve(
    model: Model,
    points: NDArray[np.int64],
    cost: NDArray[np.float64],
    extra: csr_matrix,
    extra_limit: float,
    until: float,
    stop: Callable[[], bool],
) -> float:
    """The least cost of the relaxation; minus infinity if there was no time for it."""
    relaxation = _Relaxation(model, points)
    places = np.unique(model.place_of)
    one_each = csr_matrix(
        (np.ones(model.candidates), (np.searchsorted(places, model.place_of), np.arange(model.candidates))),
        shape=(len(places), model.candidates + len(points)),
    )
    bounds = [(1.0 if c in model.kept else 0.0, 1.0) for c in range(model.candidates)] + [(0.0, 1.0)] * len(
        points
    )
    best = -np.inf
    for _ in range(ROUNDS):
        left = until - time.perf_counter()
        if left <= 0 or stop():
            break
        matrix = vstack([extra, one_each, *relaxation.rows], format="csr")
        limits = np.concatenate([[extra_limit], np.ones(len(places)), np.zeros(len(relaxation.rows))])
        found = linprog(
            cost,
            A_ub=matrix,
            b_ub=limits,
            bounds=bounds,
            method="highs",
            options={"time_limit": max(left, 0.1)},
        )
        if found.status != 0:
            break
        best = float(found.fun)
        if not relaxation.separate(found.x[: model.candidates], found.x[model.candidates :]):
            break
    return best
