"""People who walk where there is room for them, past a place."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.simulate.person import Person, Walk
from elbowroom.simulate.solid import Solid
from elbowroom.simulate.taken import Taken

EDGE_M = 0.05
"""Of the voxels of the floor's plan [m]."""
SPARE_M = 0.27
"""About the middle of a person this much is theirs: half of a body's width, and a little [m]."""
HEAD_M = 2.0
"""A person needs so much height [m]."""
SPEED_M_S = 0.9
RADII_M = ((0.9, 0.35), (0.35, 0.9), (0.6, 0.25), (0.25, 0.6), (0.35, 0.15), (0.15, 0.35), (0.08, 0.08))
"""Half axes of the ways that are tried, long ones first [m]."""
STEP_M = 0.15
"""How far apart the middles of such ways are [m]."""
STANCES = 12
"""A way is tried at so many places with the body that walks it."""
TRIED = 60
"""So many ways are tried with a body, the best first."""
NEARNESS = 0.2
"""A way that is longer by its half axes may be farther from the place by so much of it."""
ELBOWS_RAD = (1.2, 0.3)
HEIGHTS_M = (1.75, 1.68, 1.82)


@dataclass(frozen=True, slots=True, eq=False)
class Walker:
    """A person on a way, on a floor.

    Args:
        person: who.
        floor_m: height of the floor, world frame [m].
        nearest_s: when they are nearest to the place that they pass [s].
    """

    person: Person
    floor_m: float
    nearest_s: float

    def at(self, time_s: float) -> tuple[Solid, ...]:
        """Body and hair at a time [s]."""
        walk = self.person.walk
        return _lifted(self.person.solids(walk.at(time_s - self.nearest_s + walk.period_s / 2)), self.floor_m)


@dataclass(frozen=True, slots=True, eq=False)
class Floor:
    """Where people may be.

    Args:
        lower_m, upper_m: corners of the floor's rectangle, shape (2,), world frame [m].
        height_m: of the floor, world frame [m].
    """

    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]
    height_m: float

    @property
    def grid(self) -> VoxelGrid:
        """Voxels of the space that people need."""
        lower, upper = np.append(self.lower_m, self.height_m), np.append(self.upper_m, self.height_m + HEAD_M)
        return VoxelGrid.covering(lower, upper, EDGE_M)


def walkers(
    count: int, floor: Floor, taken: Taken, past_m: NDArray[np.float64], nearest_s: float
) -> tuple[Walker, ...]:
    """People who walk as near past some places as there is room, and touch nothing.

    Args:
        count: how many.
        floor: where they may be.
        taken: of the floor's grid, by what is in their way; also by where a machine comes to be.
        past_m: the places, x and y, shape (n, 2) [m].
        nearest_s: when they are nearest to one of them [s]; one after the other is later by two seconds.

    Raises:
        InputError: there is no way for so many.
    """
    found = list[Walker]()
    for number in range(count):
        walker = _walker(number, floor, taken, past_m, nearest_s + 2.0 * number)
        if walker is None:
            raise InputError(
                f"people: no way for {count}, {number} found place; fewer people, or more room about the machine"
            )
        found.append(walker)
        around = [walker.at(nearest_s + share * walker.person.walk.period_s) for share in _shares()]
        taken = taken.with_more(Taken.of(taken.grid, list(itertools.chain.from_iterable(around))))
    return tuple(found)


def _walker(
    number: int, floor: Floor, taken: Taken, past_m: NDArray[np.float64], nearest_s: float
) -> Walker | None:
    for walk in itertools.islice(_ways(floor, taken, past_m), TRIED):
        person = Person(
            f"person {number + 1}",
            walk,
            HEIGHTS_M[number % len(HEIGHTS_M)],
            ELBOWS_RAD[number % len(ELBOWS_RAD)],
        )
        walker = Walker(person, floor.height_m, nearest_s)
        places = [walker.at(nearest_s + share * walk.period_s) for share in _shares()]
        if not any(taken.meets(solid) for solid in itertools.chain.from_iterable(places)):
            return walker
    return None


def _ways(floor: Floor, taken: Taken, past_m: NDArray[np.float64]) -> Iterator[Walk]:
    """Ways with room beside them, those that are long and come near to the place first."""
    plan = (taken.inside | taken.crossed).any(axis=2)
    room_m = distance_transform_edt(np.pad(~plan, 1))[1:-1, 1:-1] * EDGE_M
    lower, grid = floor.lower_m, taken.grid
    middles = [np.arange(lower[i], floor.upper_m[i], STEP_M) for i in (0, 1)]
    near = cKDTree(past_m)
    turns = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    rated = []
    for centre in itertools.product(*middles):
        for radii in RADII_M:
            points = np.array(centre) + np.array(radii) * np.stack([np.cos(turns), np.sin(turns)], axis=1)
            index = np.floor((points - grid.lower_m[:2]) / EDGE_M).astype(int)
            if (index < 0).any() or (index >= plan.shape).any():
                continue
            if room_m[index[:, 0], index[:, 1]].min() < SPARE_M:
                continue
            distances = near.query(points)[0]
            nearest = int(distances.argmin())
            rated.append((float(distances[nearest]) - NEARNESS * sum(radii), centre, radii, turns[nearest]))
    for _, centre, radii, turn in sorted(rated, key=lambda way: way[0]):
        yield _walk((float(centre[0]), float(centre[1])), radii, float(turn))


def _walk(centre_m: tuple[float, float], radii_m: tuple[float, float], nearest_rad: float) -> Walk:
    """A walk that is half round, where it is fastest, at an angle of its ellipse."""
    length = 2 * math.pi * float(np.hypot(*radii_m)) / math.sqrt(2)
    return Walk(centre_m, radii_m, max(4.0, length / SPEED_M_S), start_rad=nearest_rad + math.pi)


def _shares() -> Iterator[float]:
    return (number / STANCES for number in range(STANCES))


def _lifted(solids: tuple[Solid, ...], by_m: float) -> tuple[Solid, ...]:
    lift = np.eye(4)
    lift[2, 3] = by_m
    return tuple(replace(solid, world_from_solid=lift @ solid.world_from_solid) for solid in solids)
