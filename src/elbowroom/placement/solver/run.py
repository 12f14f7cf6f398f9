"""From a model to a layout: an exact start on a few points, then repair and search on all, against the clock."""

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from elbowroom.files.progress import Progress
from elbowroom.geometry.parallel import default_threads, spread
from elbowroom.placement.solver.layout import Layout
from elbowroom.placement.solver.model import Model
from elbowroom.placement.solver.scene_layout import SceneLayout, SceneModel
from elbowroom.placement.solver.search import ROUNDING, Found, Searched, improve, prune, repair
from elbowroom.placement.solver.sectors import sector_layout

SECTOR_POINTS, SECTOR_SHARE, SECTOR_LONGEST_S = 300, 0.2, 20.0
"""CP-SAT gets so many points, and this share of the time, but no more than so many seconds."""
SEARCH_POINTS = 4000
"""The search looks at so many points; what it finds is counted on all of them."""
FINER = 1e-4


def never() -> bool:
    """Nobody asks to stop."""
    return False


@dataclass(slots=True, eq=False)
class Course:
    """What a run has met so far.

    Args:
        begun: when it began [s, time.perf_counter].
        steps: seconds since then, number of cameras, price and share of valid points of each better layout.
        sector_bound: price or share (0 to 1) that CP-SAT knows no choice by sectors does better at its points; None: it
            found none.
        stop: whether to come to an end now, with what was found.
    """

    begun: float
    steps: list[tuple[float, int, float, float]] = field(default_factory=list)
    sector_bound: float | None = None
    stop: Callable[[], bool] = never

    def goes_on(self, until: float) -> bool:
        """Whether there is time, and nobody asked to stop."""
        return time.perf_counter() < until and not self.stop()

    def note(self, layout: Searched) -> None:
        """Adds a better layout."""
        row = (time.perf_counter() - self.begun, len(layout.chosen), layout.price, layout.share)
        self.steps.append(row)


def cheapest(
    model: Model,
    share: float,
    until: float,
    course: Course,
    *,
    first: Sequence[int] = (),
    seed: int = 1,
    progress: Progress,
) -> Layout:
    """The cheapest layout that is found with this share of valid points.

    Args:
        model: all points.
        share: wanted, 0 to 1; it must be within reach.
        until: when to come to an end [s, time.perf_counter].
        course: is told of every better layout.
        first: a choice to start from; without one, CP-SAT's.
        seed: of the random choices. The result also depends on how much is done in the time.
        progress: called with what is being done.
    """
    rng = np.random.default_rng(seed)
    if not first:
        progress("choosing by CP-SAT on a few points")
        first = _exact(model, rng, until, course, share=share) or ()
    starts = [prune(repair(Layout.of(model, start), share), share) for start in ((), first)]
    best = min(starts, key=lambda layout: (layout.price, len(layout.chosen)))
    course.note(best)
    some = _some(model, rng)
    margin, step = 0.0, _step(model)
    here: Layout | None = None
    while course.goes_on(until):
        budget = best.price - step
        if budget < -ROUNDING:
            break
        progress(f"{len(best.chosen)} cameras, price {best.price:g}: looking for less than that")
        here = _within(here or Layout.of(some, best.chosen), budget)
        here = _search(here, budget, min(share + margin, 1.0), rng, until, course.stop)
        if here.share < min(share + margin, 1.0):
            break
        whole = Layout.of(model, here.chosen)
        if whole.share >= share:
            best = prune(whole, share)
            course.note(best)
            here = None
        else:
            margin = max(here.share - share, 0.0) + (share - whole.share) + FINER
    return best


def fullest(
    model: Model,
    budget: float,
    until: float,
    course: Course,
    *,
    seed: int = 1,
    progress: Progress,
) -> Layout:
    """The layout with most valid points that is found for at most this price.

    Args:
        model: candidates and points.
        budget: greatest price of all that is new.
        until: when time is up, as `time.perf_counter` counts [s].
        course: better layouts on the way are noted here.
        seed: of all random choices.
        progress: called with what is being done.
    """
    rng = np.random.default_rng(seed)
    progress("choosing by CP-SAT on a few points")
    exact = _exact(model, rng, until, course, budget=budget) or ()
    starts = [repair(Layout.of(model, start), 1.0, budget) for start in ((), exact)]
    best = max(starts, key=lambda layout: layout.valid)
    course.note(best)
    some = _some(model, rng)
    here = Layout.of(some, best.chosen)
    while best.share < 1.0 and course.goes_on(until):
        left = until - time.perf_counter()
        progress(f"{len(best.chosen)} cameras: {best.share:.2%} of the points valid")
        here = _search(
            here, budget, 1.0, rng, time.perf_counter() + min(left, max(left / 8, 1.0)), course.stop
        )
        whole = Layout.of(model, here.chosen)
        if whole.valid > best.valid:
            best = whole
            course.note(best)
        elif here.share >= 1.0:
            # all of these points are valid: others are wanted
            some = _some(model, rng)
            here = Layout.of(some, best.chosen)
    return best


def in_scenes(
    model: SceneModel,
    share: float | None,
    budget: float,
    until: float,
    course: Course,
    *,
    seed: int = 1,
    progress: Progress,
) -> SceneLayout:
    """The cheapest layout with a share of the free space of scenes, or with None the one that finds most for a price.

    Args:
        model: candidates, and what each sees in the scenes.
        share: of the free space that is wanted, 0 to 1; None: as much as can be.
        budget: greatest price of all that is new.
        until: when time is up, as `time.perf_counter` counts [s].
        course: better layouts on the way are noted here.
        seed: of all random choices.
        progress: called with what is being done.
    """
    rng = np.random.default_rng(seed)
    wanted = 1.0 if share is None else share
    best = repair(model.empty(), wanted, budget)
    best = best if share is None else prune(best, share)
    course.note(best)
    here = best
    while course.goes_on(until) and best.share < 1.0:
        progress(f"{len(best.chosen)} cameras find {best.share:.2%}")
        if share is None:
            left = until - time.perf_counter()
            here = _search(here, budget, 1.0, rng, time.perf_counter() + max(left / 4, 0.5), course.stop)
            if here.valid > best.valid:
                best = here
                course.note(best)
            continue
        less = best.price - _step(model)
        if less < -ROUNDING:
            break
        here = _search(_within(best, less), less, share, rng, until, course.stop)
        if here.share < share:
            break
        best = prune(here, share)
        course.note(best)
    return best


def _exact(
    model: Model,
    rng: np.random.Generator,
    until: float,
    course: Course,
    *,
    share: float = 1.0,
    budget: float | None = None,
) -> list[int] | None:
    seconds = min(SECTOR_LONGEST_S, SECTOR_SHARE * (until - time.perf_counter()))
    few = model.at(np.sort(rng.choice(model.points, min(SECTOR_POINTS, model.points), replace=False)))
    hint = repair(Layout.of(few, ()), share, np.inf if budget is None else budget).chosen
    found = sector_layout(
        few,
        share,
        max(seconds, 0.1),
        budget=budget,
        hint=hint,
        seed=int(rng.integers(2**31)),
        threads=default_threads(),
        stop=course.stop,
    )
    if found is None:
        return None
    course.sector_bound = found.bound
    return found.chosen


def _some(model: Model, rng: np.random.Generator) -> Model:
    if model.points <= SEARCH_POINTS:
        return model
    return model.at(np.sort(rng.choice(model.points, SEARCH_POINTS, replace=False)))


def _step(model: Model | SceneModel) -> float:
    """By how much less a layout must cost to be worth looking for: the least price, a thousandth of all at least."""
    prices = model.price[model.price > 0]
    if not len(prices):
        return 1.0
    return float(prices.min()) if np.ptp(prices) < ROUNDING else 0.01 * float(np.median(prices))


def _within(layout: Found, budget: float) -> Found:
    """The layout without what is worth least for its price, until the budget is kept."""
    while layout.price > budget + ROUNDING:
        loss = layout.losses() / np.maximum(layout.model.price[layout.chosen], ROUNDING)
        loss[[c in layout.model.kept for c in layout.chosen]] = np.inf
        layout = layout.without([layout.chosen[int(np.argmin(loss))]])
    return layout


def _search(
    layout: Found,
    budget: float,
    share: float,
    rng: np.random.Generator,
    until: float,
    stop: Callable[[], bool],
) -> Found:
    """Several searches side by side, one a core; the first that reaches the share ends all."""
    done = threading.Event()

    def ends() -> bool:
        return done.is_set() or stop()

    def one(seed: int) -> Found:
        found = improve(layout, budget, share, np.random.default_rng(seed), until, ends)
        if found.share >= share:
            done.set()
        return found

    found = spread(one, [int(rng.integers(2**31)) for _ in range(default_threads())])
    return max(found, key=lambda one: (one.valid, one.value))
