"""Where to put cameras so that they find most in use: random scenes in place of the rule of the empty room."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.progress import Progress, silent
from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.motion import blocks_in_reach
from elbowroom.placement.candidates import Candidate
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.placement.optimisation import Goal, Search, free_candidates, named, places_of, step_rows
from elbowroom.placement.rehearsal import Settings, evidence_by_camera
from elbowroom.placement.solver.run import Course, in_scenes
from elbowroom.placement.solver.scene_layout import SceneModel
from elbowroom.placement.solver.swept_layout import SweptModel
from elbowroom.placement.swept.swept import swept_by_link
from elbowroom.simulate import Moment, true_occupancy

COARSE_VOXEL_M, COARSE_PX = 0.1, 96
"""Candidates are carved at no less than this edge, with pixels joined as long as so many stay across."""
SWEPT_PX = 200
"""For what motions sweep, candidates are carved in the site's own voxels, with so many pixels across at least."""
WHOLE_WAY = 0.25
"""A motion's whole way is worth this share of what its braking distance is worth: only there it is stopped."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundInUse:
    """A layout that was found by scenes.

    Args:
        cameras: those that were there, then the new ones.
        bought: the new ones as candidates.
        free_pct: share of the truly free space of the scenes that it finds, as coarsely as candidates are carved [%].
        bound: no layout of these candidates does better in these scenes: cameras, or share [%].
        steps: seconds, cameras, price and share (0 to 1) of every better layout on the way.
        seconds: what it took.
    """

    cameras: tuple[DepthCamera, ...]
    bought: tuple[Candidate, ...]
    free_pct: float
    bound: float
    steps: tuple[tuple[float, int, float, float], ...]
    seconds: float

    def row(self) -> dict[str, Any]:
        """How good the layout is in its own scenes, how much better one could be, and what it took."""
        return {
            "cameras": len(self.cameras),
            "free_in_own_scenes_pct": self.free_pct,
            "bound": self.bound,
            "seconds": self.seconds,
        }

    def step_rows(self) -> list[dict[str, Any]]:
        """A row of kind "step" for every better layout on the way."""
        return step_rows(self.steps, "free_pct")


LONG = Search()


def optimise_in_use(
    candidates: Sequence[Candidate],
    scenes: Sequence[Moment],
    settings: Settings,
    goal: Goal,
    *,
    existing: Sequence[DepthCamera] = (),
    search: Search = LONG,
    progress: Progress = silent,
) -> FoundInUse:
    """Chooses the candidates that find most of the free space of scenes, each carved with the code that runs.

    Every candidate is carved alone, coarsely; what several know together follows from their planes by rule `three`, as
    `merge` and `resolve` have it. Judge the result by `rehearse`, with other scenes and in full detail.

    With `goal.by_motions`, motions count instead, from the machine's pose in each scene: each is worth 1 if all of the
    truly free space that it sweeps within its braking distance is found, a half if `FEW` voxels of it are not, and so
    on down: a voxel that is not found there stops it for nothing. Its whole way counts in the same manner, `WHOLE_WAY`
    times as much. Candidates are carved in the site's own voxels then, where motions can go.

    Args:
        candidates: what may be bought.
        scenes: moments of the room in use.
        settings: how space is declared free; the rule must be three.
        goal: its share is that of the truly free space; a number of cameras; or the least price.
        existing: cameras that stay.
        search: its time, on top of which carving the candidates comes; the seed of noise and random choices.
        progress: called with what is being done.

    Raises:
        InputError: no candidates, no scenes, another rule, no motions to count by, or a share that all candidates
            together do not find.
    """
    begun = time.perf_counter()
    if settings.terms.rule != "three":
        raise InputError(
            f"placement: optimising by scenes knows rule three, the site has {settings.terms.rule}"
        )
    if not scenes:
        raise InputError("placement: no scene, at least one is needed")
    if goal.by_motions and (settings.machine is None or not settings.motions):
        raise InputError(
            "placement: no machine with speeds of its joints, so no motions to place cameras for"
        )
    free = free_candidates(candidates, existing)
    model = _model(free, existing, scenes, settings, goal, search.seed, progress)
    share = None if goal.cameras is not None else goal.share_pct / 100
    if share is not None and model.share_bound < share:
        raise InputError(
            f"placement: {goal.share_pct:g} % is out of reach: all {len(free)} candidates together see through "
            f"{100 * model.share_bound:.2f} % of the free space of these scenes; add mounts or aims, or ask for less"
        )
    course = Course(time.perf_counter(), stop=search.stop)
    until = course.begun + search.seconds
    budget = math.inf if goal.cameras is None else float(goal.cameras - len(existing))
    layout = in_scenes(model, share, budget, until, course, seed=search.seed, progress=progress)
    bought = named([free[c - len(existing)] for c in layout.chosen if c >= len(existing)], existing)
    return FoundInUse(
        (*existing, *(candidate.camera for candidate in bought)),
        tuple(bought),
        100 * layout.share,
        100 * model.share_bound if share is None else model.camera_bound(share),
        tuple(course.steps),
        time.perf_counter() - begun,
    )


def _model(
    free: Sequence[Candidate],
    existing: Sequence[DepthCamera],
    scenes: Sequence[Moment],
    settings: Settings,
    goal: Goal,
    seed: int,
    progress: Progress,
) -> SceneModel:
    coarse, least_px = (settings, SWEPT_PX) if goal.by_motions else (_coarse(settings), COARSE_PX)
    everything = [*existing, *(candidate.camera for candidate in free)]
    cameras = [
        replace(with_joined_pixels(camera, least_px), name=f"{number}")
        for number, camera in enumerate(everything)
    ]
    through, disputed, truly = [], [], []
    for number, moment in enumerate(scenes):
        progress(f"scene {number + 1} of {len(scenes)}: carving {len(cameras)} candidates")
        planes, focus = _counted(moment, coarse, goal.by_motions)
        parts = evidence_by_camera(cameras, moment, coarse, seed + number, focus)
        for plane in planes:
            words = np.flatnonzero(plane) if goal.by_motions else np.arange(len(plane))
            through.append(np.array([part.through[0][words] for part in parts]))
            disputed.append(np.array([part.disputed[words] for part in parts]))
            truly.append(plane[words])
    plane = np.concatenate(truly)
    common = (
        np.concatenate(through, axis=1),
        np.concatenate(disputed, axis=1),
        plane,
        int(np.unpackbits(plane.view(np.uint8)).sum()),
        places_of(free, existing),
        np.array([*[0.0] * len(existing), *(c.price if goal.by_price else 1.0 for c in free)]),
        tuple(range(len(existing))),
    )
    if not goal.by_motions:
        return SceneModel(*common)
    start = np.concatenate([[0], np.cumsum([len(words) for words in truly])]).astype(np.int64)
    return SweptModel(*common, start, np.tile([1.0, WHOLE_WAY], len(truly) // 2))


def _coarse(settings: Settings) -> Settings:
    """The settings with voxels of `COARSE_VOXEL_M` at least."""
    grid = settings.grid
    edge = max(COARSE_VOXEL_M, grid.voxel_size_m)
    return replace(settings, grid=VoxelGrid.covering(grid.lower_m, grid.upper_m, edge))


def _counted(
    moment: Moment, settings: Settings, by_motions: bool
) -> tuple[list[Words], NDArray[np.bool_] | None]:
    """Planes of the truly free voxels that count, two of each motion: braking distance, whole way; and what to ask."""
    grid, machine = settings.grid, settings.machine
    truth = true_occupancy(grid, moment)
    free = bits.pack(~truth.occupied & ~truth.machine, grid)
    if not by_motions or machine is None:
        return [free], None
    planes = []
    for motion in settings.motions:
        for each in (replace(motion, reach=motion.braking_distance), motion):
            swept = swept_by_link(grid, machine, moment.joints, [each])
            planes.append(free & bits.pack(_union(swept, grid), grid))
    return planes, blocks_in_reach(grid, machine, moment.joints, settings.motions)


def _union(by_link: Mapping[str, NDArray[np.bool_]], grid: VoxelGrid) -> NDArray[np.bool_]:
    return np.asarray(np.logical_or.reduce([np.zeros(grid.shape, dtype=np.bool_), *by_link.values()]))
