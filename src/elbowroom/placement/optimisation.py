"""Where to put cameras so that few or cheap ones see an empty room well enough, or a given number as well as can be."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.extras import package
from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.placement.candidates import Candidate
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.requirement import Requirement
from elbowroom.placement.solver.bound import price_bound, share_bound
from elbowroom.placement.solver.layout import Layout
from elbowroom.placement.solver.model import Model, build_model
from elbowroom.placement.solver.run import Course, cheapest, fullest, never
from elbowroom.placement.solver.sectors import CP_SAT
from elbowroom.placement.verification import Verification, verify

TAKEN_M = 0.1
"""A mount so near to a camera that hangs there already is taken [m]."""
BOUND_SHARE = 0.2
VERIFY_TRIES = 6
LATER_SHARE = 0.25
"""This share of the time is kept for raising the share after a verification that found less than the solver."""
SPARE = 2e-4
"""When the verification finds less than the model, so much more than the difference is asked for next [share]."""


@dataclass(frozen=True, slots=True)
class Goal:
    """What is wanted: a share of valid points with few or cheap cameras, or the best share with a number of them.

    Args:
        share_pct: share of valid points [%]; used if `cameras` is None.
        cameras: number of cameras, those that are there already among them; None: as few or cheap as can be.
        by_price: the cheapest layout rather than the one of fewest cameras.
        by_motions: in scenes, the share is of what the motions sweep (`optimise_in_use`).

    Raises:
        InputError: a share that is none, fewer than one camera, or both price and number.
    """

    share_pct: float = 98.9
    cameras: int | None = None
    by_price: bool = False
    by_motions: bool = False

    def __post_init__(self) -> None:
        if not 0 < self.share_pct <= 100:
            raise InputError(f"placement: share is {self.share_pct:g} %, must be above 0 and at most 100")
        if self.cameras is not None and not 1 <= self.cameras <= 255:
            raise InputError(f"placement: {self.cameras} cameras, must be 1 to 255")
        if self.cameras is not None and self.by_price:
            raise InputError("placement: either a number of cameras or the least price, not both")

    @property
    def bound_of(self) -> str:
        """What a bound is of: "valid_pct", "price" or "cameras"."""
        if self.cameras is not None:
            return "valid_pct"
        return "price" if self.by_price else "cameras"


@dataclass(frozen=True, slots=True)
class Search:
    """How long and how closely the solver looks.

    Args:
        seconds: time for search and bound; the first layout and the last verification may take a little longer.
        points: number of voxel centres, drawn at random, that the solver looks at.
        seed: of all random choices.
        stop: asked many times a second; the search ends with the best that it has when it says so.
    """

    seconds: float = 60.0
    points: int = 20_000
    seed: int = 1
    stop: Callable[[], bool] = never


@dataclass(frozen=True, slots=True, eq=False)
class Optimised:
    """A layout that was found.

    Args:
        cameras: those that were there, then the new ones.
        bought: the new ones as candidates, in that order.
        found: what `verify` says of them on the whole grid.
        model_pct: share of valid points that the solver's own model counted [%].
        bound: no layout of these candidates does better at the solver's points: cameras, price, or share [%].
        sector_bound: no choice by narrow sectors does better at CP-SAT's few points, in the same unit: closer, but no
            proof for all layouts. None: CP-SAT found none.
        steps: seconds, cameras, price and share (0 to 1) of every better layout on the way.
        points, candidates: how many of each the solver had.
        seconds: what it took.
    """

    cameras: tuple[DepthCamera, ...]
    bought: tuple[Candidate, ...]
    found: Verification
    model_pct: float
    bound: float
    sector_bound: float | None
    steps: tuple[tuple[float, int, float, float], ...]
    points: int
    candidates: int
    seconds: float

    @property
    def price(self) -> float:
        """Of all new cameras with their mounts and cables."""
        return sum(candidate.price for candidate in self.bought)

    def row(self) -> dict[str, Any]:
        """How good the layout is, how much better one could be, and what it took."""
        return {
            "bound": self.bound,
            "sector_bound": self.sector_bound,
            "price": self.price,
            "model_valid_pct": self.model_pct,
            "solver_points": self.points,
            "candidates": self.candidates,
            "seconds": self.seconds,
        }

    def step_rows(self) -> list[dict[str, Any]]:
        """A row of kind "step" for every better layout on the way."""
        return step_rows(self.steps, "valid_pct")


def step_rows(steps: Sequence[tuple[float, int, float, float]], share: str) -> list[dict[str, Any]]:
    """Rows of kind "step".

    Args:
        steps: seconds, cameras, price and share (0 to 1) of each.
        share: what the share is of, such as "valid_pct".
    """
    return [
        {"kind": "step", "seconds": at, "cameras": count, "price": price, share: 100 * part}
        for at, count, price, part in steps
    ]


def optimise(
    grid: VoxelGrid,
    room: FixedRoom | None,
    candidates: Sequence[Candidate],
    requirement: Requirement | None = None,
    goal: Goal | None = None,
    *,
    existing: Sequence[DepthCamera] = (),
    search: Search = Search(),
    progress: Progress = silent,
) -> Optimised:
    """Chooses among candidates, keeps what exists, and verifies the choice.

    Args:
        grid: the watched box.
        room: walls and furniture; None: not known.
        candidates: what may be bought; cameras at one mount exclude each other.
        requirement: None: three views, 100 degrees apart.
        goal: None: 98.9 % of the points with the fewest cameras.
        existing: cameras that stay where they are; mounts within 10 cm of one are taken.
        search: time, points and seed of the solver.
        progress: called with what is being done.

    Raises:
        PackageError: CP-SAT is not installed.
        InputError: no candidates, or a goal that no choice of the candidates can meet: then the message says where
            nobody can see, and what share is within reach.
    """
    begun = time.perf_counter()
    wanted, aim = requirement or Requirement(), goal or Goal()
    package(CP_SAT)
    free = free_candidates(candidates, existing)
    if aim.cameras is not None and aim.cameras < len(existing):
        raise InputError(f"placement: {aim.cameras} cameras wanted, {len(existing)} hang there already")
    sample = sample_points(grid, room, search.points, search.seed)
    model = _model(sample, room, free, existing, wanted, aim, progress)
    reach = Layout.of(model, range(model.candidates))
    if aim.cameras is None and reach.share < aim.share_pct / 100 - 1e-12:
        raise InputError(_out_of_reach(aim.share_pct, reach, sample, wanted))
    until = begun + search.seconds
    course = Course(begun, stop=search.stop)
    progress("bounding what can be reached")
    bound = _bound(model, reach, aim, search, len(existing))
    share, first = aim.share_pct / 100, list[int]()
    for attempt in range(VERIFY_TRIES):
        if aim.cameras is None:
            # what is left of the time is for raising the share where the whole grid has less of it than the points
            end, seed = until - LATER_SHARE * search.seconds / 2**attempt, search.seed + attempt
            layout = cheapest(model, share, end, course, first=first, seed=seed, progress=progress)
        else:
            budget = aim.cameras - len(existing)
            layout = fullest(model, budget, until, course, seed=search.seed, progress=progress)
        progress("verifying")
        bought = named([free[c - len(existing)] for c in layout.chosen if c >= len(existing)], existing)
        cameras = (*existing, *(candidate.camera for candidate in bought))
        found = verify(grid, cameras, room, wanted)
        if aim.cameras is not None or found.valid_pct >= aim.share_pct or search.stop():
            break
        share = min(max(share, layout.share) + (aim.share_pct - found.valid_pct) / 100 + SPARE, reach.share)
        first = layout.chosen
    return Optimised(
        cameras=cameras,
        bought=tuple(bought),
        found=found,
        model_pct=100 * layout.share,
        bound=bound,
        sector_bound=_in_unit_of(aim, course.sector_bound, len(existing)),
        steps=tuple(course.steps),
        points=model.points,
        candidates=len(free),
        seconds=time.perf_counter() - begun,
    )


def sample_points(grid: VoxelGrid, room: FixedRoom | None, count: int, seed: int) -> NDArray[np.float64]:
    """Centres of voxels that nothing fixed touches, drawn at random without repetition, shape (n, 3) [m].

    Args:
        grid: the watched box.
        room: walls and furniture; None: not known.
        count: how many; fewer if there are fewer.
        seed: of the draw.

    Raises:
        InputError: there is none, or fewer than one is asked for.
    """
    if count < 1:
        raise InputError(f"placement: {count} points, at least 1 is needed")
    asked = np.flatnonzero(
        (np.ones(grid.shape, dtype=bool) if room is None else ~room.occupied(grid)).reshape(-1)
    )
    if not len(asked):
        raise InputError("placement: the watched box lies wholly inside walls or furniture; correct the room")
    rng = np.random.default_rng(seed)
    drawn = np.sort(rng.choice(asked, min(count, len(asked)), replace=False))
    return grid.centre_of(np.stack(np.unravel_index(drawn, grid.shape), axis=-1))


def _model(
    sample: NDArray[np.float64],
    room: FixedRoom | None,
    free: Sequence[Candidate],
    existing: Sequence[DepthCamera],
    requirement: Requirement,
    goal: Goal,
    progress: Progress,
) -> Model:
    """Existing cameras first, each at a place of its own, then the candidates by mount."""
    return build_model(
        [*existing, *(c.camera for c in free)],
        places_of(free, existing),
        [*[0.0] * len(existing), *(c.price if goal.by_price else 1.0 for c in free)],
        sample,
        None if room is None else room.triangles,
        requirement,
        kept=range(len(existing)),
        progress=progress,
    )


def _bound(model: Model, reach: Layout, goal: Goal, search: Search, existing: int) -> float:
    """Cameras in all, price, or share [%] that no layout does better than."""
    until = time.perf_counter() + BOUND_SHARE * search.seconds
    if goal.cameras is not None:
        return 100 * min(share_bound(model, goal.cameras - existing, until, search.stop), reach.share)
    least = price_bound(model, goal.share_pct / 100, until, search.stop)
    return float(_in_unit_of(goal, least, existing) or 0.0)


def _in_unit_of(goal: Goal, bound: float | None, existing: int) -> float | None:
    """A price or share of the model as cameras in all, price, or share [%]."""
    if bound is None:
        return None
    if goal.cameras is not None:
        return 100 * min(bound, 1.0)
    return bound if goal.by_price else float(np.ceil(bound - 1e-6)) + existing


def free_candidates(candidates: Sequence[Candidate], existing: Sequence[DepthCamera]) -> list[Candidate]:
    """Those whose mount is not taken by a camera that hangs there already.

    Raises:
        InputError: there is none.
    """
    eyes = [camera.centre_in_world for camera in existing]
    free = [c for c in candidates if all(np.linalg.norm(eye - c.mount.position_m) >= TAKEN_M for eye in eyes)]
    if not free:
        raise InputError(
            "placement: no candidates; every mount is taken by a camera that hangs there already"
        )
    return free


def places_of(free: Sequence[Candidate], existing: Sequence[DepthCamera]) -> NDArray[np.int64]:
    """The place of each existing camera, one each, and of each candidate, one a mount; shape (n,)."""
    mounts = {
        name: n for n, name in enumerate(dict.fromkeys(c.mount.name for c in free), start=len(existing))
    }
    return np.array([*range(len(existing)), *(mounts[c.mount.name] for c in free)], dtype=np.int64)


def named(bought: Sequence[Candidate], existing: Sequence[DepthCamera]) -> list[Candidate]:
    """Names that no camera there has."""
    taken = {camera.name for camera in existing}
    named = []
    for candidate in bought:
        name, number = candidate.camera.name, 2
        while name in taken:
            name, number = f"{candidate.camera.name}-{number}", number + 1
        taken.add(name)
        named.append(replace(candidate, camera=replace(candidate.camera, name=name)))
    return named


def _out_of_reach(
    share_pct: float, reach: Layout, sample: NDArray[np.float64], requirement: Requirement
) -> str:
    """One line: what is within reach, and where nobody can see."""
    model = reach.model
    unseen = sample[~model.sees.any(axis=0)]
    failing = sample[reach.apart < requirement.views]
    where = f"; {len(failing):,} of {model.points:,} points fail, {_box(failing)}"
    if len(unseen):
        where += f"; {len(unseen):,} that nobody can see, {_box(unseen)}"
    return (
        f"placement: {share_pct:g} % is out of reach: with all {model.candidates} candidates at once "
        f"{100 * reach.share:.2f} % of the points have {requirement.words}{where}; add mounts or aims, or ask for less"
    )


def _box(points: NDArray[np.float64]) -> str:
    low, high = points.min(axis=0), points.max(axis=0)
    parts = [f"{name} {a + 0.0:.3g} to {b + 0.0:.3g}" for name, a, b in zip("xyz", low, high, strict=True)]
    if len(points) == 1:
        return f"at {points[0].round(3).tolist()} m"
    return "within " + ", ".join(parts) + f" m, such as {points[len(points) // 2].round(2).tolist()}"
