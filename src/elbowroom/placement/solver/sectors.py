"""An exact choice on a few points, by CP-SAT: narrow sectors that are far enough apart, whatever is taken from each.

A point with a view in each of `views` sectors of width 360 / views - angle, whose middles are 360 / views apart, has
views that are pairwise at least the angle apart. That is sufficient, not necessary: some points are valid otherwise.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.extras import package
from elbowroom.placement.solver.model import Model

CP_SAT = "ortools.sat.python.cp_model"
ROTATIONS = 12
LEAST_WIDTH_DEG = 2.0
"""Narrower sectors hold hardly any view: then the search starts without them."""


class SectorChoice(NamedTuple):
    """Candidates, and what CP-SAT knows no choice does better at these points by sectors: price, or share (0 to 1)."""

    chosen: list[int]
    bound: float


def sector_layout(
    model: Model,
    share: float,
    seconds: float,
    *,
    budget: float | None = None,
    hint: Sequence[int] = (),
    seed: int = 1,
    threads: int = 2,
    stop: Callable[[], bool] = lambda: False,
) -> "SectorChoice | None":
    """The cheapest choice with which this share of the model's points has views in sectors; or the best for a budget.

    Args:
        model: of a few hundred points.
        share: of points, 0 to 1; not used with a budget.
        seconds: time limit [s].
        budget: greatest price, for as many points as possible; None: the share for the least price.
        hint: a choice to start from.
        seed, threads: of the solver.
        stop: asked many times a second; the solver ends with what it has when it says so.

    Returns:
        The choice; None if none was found in time, or the sectors are too narrow.

    Raises:
        PackageError: CP-SAT is not installed.
    """
    cp = package(CP_SAT)
    inside = _inside(model)
    if inside is None:
        return None
    problem = cp.CpModel()
    chosen = _choices(model, problem)
    valid = _valid_points(model, inside, problem, chosen)
    # CP-SAT counts in whole numbers: prices in thousandths of the greatest
    scale = 1000 / max(float(model.price.max()), 1e-9)
    price = sum(
        round(float(model.price[c]) * scale) * chosen[c]
        for c in range(model.candidates)
        if c not in model.kept
    )
    if budget is None:
        wanted = int(np.floor(share * model.points))
        problem.add(sum(valid) >= min(wanted, len(valid)))
        problem.minimize(price)
    else:
        problem.add(price <= int(np.floor(budget * scale + 1e-6)))
        problem.maximize(sum(valid))
    for c in range(model.candidates):
        if hint:
            problem.add_hint(chosen[c], c in set(hint))
    solver = cp.CpSolver()
    solver.parameters.max_time_in_seconds = seconds
    solver.parameters.num_workers = threads
    solver.parameters.random_seed = seed
    # it would keep Ctrl-C for itself
    solver.parameters.catch_sigint_signal = False
    if _solved(solver, problem, stop) not in (cp.OPTIMAL, cp.FEASIBLE):
        return None
    members = [c for c in range(model.candidates) if solver.value(chosen[c])]
    bound = solver.best_objective_bound
    return SectorChoice(members, bound / scale if budget is None else bound / model.points)


def _solved(solver: Any, problem: Any, stop: Callable[[], bool]) -> Any:
    """The solver's status; beside it, so that Ctrl-C is heard while it works."""
    with ThreadPoolExecutor(1) as pool:
        working = pool.submit(solver.solve, problem)
        try:
            while not wait([working], timeout=0.05).done:
                if stop():
                    solver.stop_search()
        except BaseException:
            solver.stop_search()
            raise
        return working.result()


def _choices(model: Model, problem: Any) -> list[Any]:
    """A variable for each candidate: kept ones are chosen, of each place one at most."""
    chosen = [problem.new_bool_var(f"c{c}") for c in range(model.candidates)]
    for c in model.kept:
        problem.add(chosen[c] == 1)
    for place in np.unique(model.place_of):
        here = np.flatnonzero(model.place_of == place)
        if len(here) > 1:
            problem.add_at_most_one([chosen[c] for c in here])
    return chosen


def _valid_points(
    model: Model, inside: list[list[NDArray[np.bool_]]], problem: Any, chosen: list[Any]
) -> list[Any]:
    """A variable for each point that can be valid: it needs a view in each sector of one of the rotations."""
    views, valid = model.requirement.views, []
    for p in range(model.points):
        turns = []
        for turn in range(ROTATIONS):
            sectors = [
                np.flatnonzero(model.sees[:, p].astype(bool) & inside[turn][sector][model.place_of, p])
                for sector in range(views)
            ]
            if all(len(some) for some in sectors):
                met = problem.new_bool_var("")
                for some in sectors:
                    problem.add_bool_or([chosen[c] for c in some]).only_enforce_if(met)
                turns.append(met)
        if turns:
            point = problem.new_bool_var("")
            problem.add_bool_or([*turns, point.negated()])
            # follows from the sectors; it is what the solver's linear relaxation works with
            problem.add(sum(chosen[c] for c in np.flatnonzero(model.sees[:, p])) >= views * point)
            valid.append(point)
    return valid


def _inside(model: Model) -> list[list[NDArray[np.bool_]]] | None:
    """By rotation and sector, which place lies in it seen from each point, shape (places, points)."""
    views, angle = model.requirement.views, model.requirement.angle_deg
    apart = 360.0 / views
    width = apart - angle if views > 1 else 360.0
    if width < LEAST_WIDTH_DEG:
        return None
    azimuth = np.degrees(model.azimuth)
    with np.errstate(invalid="ignore"):
        return [
            [
                np.mod(azimuth - (turn * apart / ROTATIONS + sector * apart), 360.0) <= width
                for sector in range(views)
            ]
            for turn in range(ROTATIONS)
        ]
