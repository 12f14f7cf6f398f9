"""Where the scale model's four Kinects stand: from where they see most of the motions' ways, and lose little to noise.

Candidates stand on rings about the middle of the C. For each motion that the evaluation judges, every voxel of its way
is asked of every candidate: does it see through it in an exact image? And in images with noise, does it see through
it, or dispute it? A camera that looks at an object from the front keeps three sigmas clear of it and disputes them, one
that looks past it does not. The noise is another than the one that is judged, and of two draws the worse counts. Then
four candidates are chosen, one exchanged at a time, that have the most ways in view for which what is due holds: half
of them short by less than the median that is due, none by more than the worst, nor any that is all but in view. First
among candidates far apart, then among closer ones about the best fours.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.shares.work_force import do_work
from elbowroom.evaluate.thesis.best_fours import ALL_BUT_IN_VIEW, best_fours, shortfalls
from elbowroom.evaluate.thesis.scale import near_m
from elbowroom.evaluate.thesis.scale_model import (
    AIM_M,
    LABORATORY,
    POSES,
    VOXEL_M,
    model_machine,
    model_pose,
    model_solids,
)
from elbowroom.evaluate.thesis.seen_ways import Shown, shown
from elbowroom.simulate.machine_solids import link_solids

Rings = tuple[Sequence[float], Sequence[float], Sequence[float]]
RINGS: Rings = (
    np.arange(0.65, 0.91, 0.05).tolist(),
    list(range(0, 360, 20)),
    (0.03, 0.12, 0.25, 0.45, 0.7, 0.9),
)
"""Distances [m], azimuths [degrees] and heights [m] of the candidates of the first search."""
CLOSER_RINGS: Rings = (
    np.arange(0.65, 0.96, 0.05).tolist(),
    list(range(0, 360, 5)),
    np.arange(0.03, 0.95, 0.07).tolist(),
)
"""And of the second."""
BEST, NEAR_BEST_M = 3, 0.085
"""The second search is among the places this near to those of so many best fours [m]."""
CLEAR_M = 0.53
"""Nothing is nearer to a Kinect than this, which measures from 0.5 m on [m]."""
FEWEST = 5
"""At least so many candidates are asked: four of them are chosen."""
Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Extent:
    """How much is searched.

    Args:
        poses: of the machine, the first of those that are judged.
        step: one of so many candidates is asked, but at least five.
        draws: of noise, in the first search and the second.
    """

    poses: int = POSES
    step: int = 1
    draws: tuple[int, int] = (1, 2)


WHOLE = Extent()


def scale_camera_rows(tell: Tell, extent: Extent = WHOLE, *, jobs: int = 1) -> Iterator[dict[str, Any]]:
    """The best fours of both searches, the best of each first.

    Args:
        tell: told what is being done.
        extent: how much is searched.
        jobs: processes on this computer.

    Yields:
        Rows of search, candidates, score, ways_in_view, median and worst of what these are short by, of those all but
        in view and of all [mm], places_m.
    """
    search = _Search(tell, extent, jobs)
    best = []
    for row, places in search.fours("far apart", on_rings(*RINGS), extent.draws[0]):
        best.append(places)
        yield row
    closer, about = on_rings(*CLOSER_RINGS), np.concatenate(best[:BEST])
    away = np.linalg.norm(closer[:, None] - about[None], axis=2).min(axis=1)
    for row, _ in search.fours("about the best", closer[away <= NEAR_BEST_M], extent.draws[1]):
        yield row


def on_rings(
    distances_m: Sequence[float], azimuths_deg: Sequence[float], heights_m: Sequence[float]
) -> NDArray[np.float64]:
    """Places that are clear of model and machine, shape (n, 3) [m].

    Args:
        distances_m: of the middle of the C.
        azimuths_deg: about it.
        heights_m: above the floor.
    """
    places = []
    for distance, azimuth, height in itertools.product(distances_m, np.radians(azimuths_deg), heights_m):
        across_squared = distance**2 - (height - AIM_M[2]) ** 2
        if across_squared > 0.1:
            across = np.sqrt(across_squared)
            places.append((across * np.cos(azimuth), across * np.sin(azimuth), height))
    clear = [np.linalg.norm(_in_the_way() - place, axis=1).min() > CLEAR_M for place in places]
    return np.array(places)[clear]


@cache
def _in_the_way() -> NDArray[np.float64]:
    """Corners of the model, and of the machine in all poses, shape (n, 3), world frame [m]."""
    objects = [s.vertices_in_world for s in model_solids() if s.name not in LABORATORY]
    links = [link_solids(model_machine(), model_pose(pose)[0]) for pose in range(POSES)]
    return np.concatenate([*objects, *(s.vertices_in_world for solids in links for s in solids)])


class _Search:
    """Looks for the best fours of candidates."""

    def __init__(self, tell: Tell, extent: Extent, jobs: int) -> None:
        self._tell, self._extent, self._jobs = tell, extent, jobs

    def fours(
        self, name: str, places: NDArray[np.float64], draws: int
    ) -> Iterator[tuple[dict[str, Any], NDArray[np.float64]]]:
        """The best fours among some places, by so many draws of noise: what they see, and where they stand."""
        places = places[:: min(self._extent.step, max(1, len(places) // FEWEST))]
        ways = self._ways(name, places, draws)
        self._tell(f"{name}: choosing four of {len(places)} candidates")
        for score, chosen in best_fours(ways, len(places))[: 2 * BEST]:
            row = {
                "search": name,
                "poses": self._extent.poses,
                "candidates": len(places),
                "score": score,
                **_short_by(ways, chosen),
                "places_m": np.round(places[chosen], 3).tolist(),
            }
            yield row, places[chosen]

    def _ways(self, name: str, places: NDArray[np.float64], draws: int) -> list[Shown]:
        """What all candidates see, pose by pose."""
        poses = self._extent.poses
        found: dict[int, list[Shown]] = {}
        asked = [partial(shown, pose, places, draws) for pose in range(poses)]
        self._tell(f"{name}: {len(places)} candidates, 0 of {poses} poses")
        for pose, ways in do_work(asked, jobs=self._jobs):
            found[pose] = ways
            self._tell(f"{name}: {len(places)} candidates, {len(found)} of {poses} poses")
        return [way for pose in range(poses) for way in found[pose]]


def _short_by(ways: Sequence[Shown], chosen: Sequence[int]) -> dict[str, Any]:
    """How many ways four candidates have in view, and median and worst of what they are short by [mm]."""
    hidden, blocked = (mm[chosen[3]] for mm in shortfalls(ways, chosen[:3]))
    mine, near = (blocked[hidden <= 1000 * more * near_m(VOXEL_M)] for more in (1, ALL_BUT_IN_VIEW))
    row: dict[str, Any] = {"ways": len(ways), "ways_in_view": len(mine), "all_but_in_view": len(near)}
    for words, short in (("in_view", mine), ("all_but", near), ("all", blocked)):
        row[f"median_{words}_mm"] = float(np.median(short)) if len(short) else None
        row[f"worst_{words}_mm"] = float(short.max()) if len(short) else None
    return row
