"""A room in use: what never moves, a machine that swings about a pose, people who walk past it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.simulate.crowd import Floor, Walker, walkers
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.postures import Postures
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Moment, Solid
from elbowroom.simulate.swing import Swing
from elbowroom.simulate.taken import Taken, fine_grid

NEAREST_AT = 0.7
"""People are nearest to the machine after this share of the time that is looked at."""

SPARE_M = 0.1
"""So near people come to where the machine will be, and to cameras [m]."""
HOUSING_M = 0.2
"""A camera takes so much space, with what is right before it [m]."""
MACHINE_PLACES = 12
"""At so many moments it is looked where that is."""


class InUse(Protocol):
    """A room that knows what is in it at a time."""

    def at(self, time_s: float) -> Moment:
        """All that is in the room at a time [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """What is asked of a scene.

    Args:
        times_s: the times that will be looked at, rising [s].
        joints: where the machine is, or what it swings about, by name [m or rad]; None: some pose that touches nothing.
        moves: whether the machine moves.
        speeds: full speeds of its joints [m/s or rad/s].
        people: how many walk.
        seed: of the pose that is looked for.
    """

    times_s: Sequence[float]
    joints: Mapping[str, float] | None = None
    moves: bool = True
    speeds: Mapping[str, float] = field(default_factory=dict)
    people: int = 0
    seed: int = 1


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """A room in use. It remembers nothing.

    Args:
        fixed: what never moves.
        machine: None: there is none.
        swing: where it is.
        people: who walks.
        start_s: the time at which the machine begins to swing [s].
        notes: what one should know of the machine's pose and way.
    """

    fixed: tuple[Solid, ...]
    machine: Machine | None
    swing: Swing
    people: tuple[Walker, ...]
    start_s: float
    notes: tuple[str, ...] = ()

    def at(self, time_s: float) -> Moment:
        """All that is in the room at a time [s]."""
        joints = self.swing.at(time_s - self.start_s)
        links = () if self.machine is None else link_solids(self.machine, joints)
        bodies = tuple(solid for walker in self.people for solid in walker.at(time_s))
        return Moment(time_s, self.fixed + bodies + links, joints)


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """Where a scene plays.

    Args:
        box: the watched box.
        solids: closed, never move.
        surfaces: meshes without an inside.
        floor: where people may be.
        eyes_m: where cameras are, shape (n, 3), world frame [m]; nobody walks through them.
    """

    box: VoxelGrid
    solids: tuple[Solid, ...]
    surfaces: tuple[Solid, ...]
    floor: Floor
    eyes_m: NDArray[np.float64]

    @property
    def fixed(self) -> tuple[Solid, ...]:
        """All that never moves."""
        return self.solids + self.surfaces


def scene_in(around: Surroundings, machine: Machine | None, course: Course) -> Scene:
    """A scene in some surroundings: a pose that touches nothing, a swing that touches nothing, ways that are free.

    Args:
        around: where it plays.
        machine: whose base is where it stands; None: there is none.
        course: what is asked.

    Raises:
        MachineError: joints that are not possible.
        InputError: no pose of the machine that touches nothing, or no way for the people.
    """
    swing, notes = _swing(around, machine, course)
    start_s, end_s = course.times_s[0], course.times_s[-1]
    links = []
    if machine is not None:
        some = np.linspace(0.0, end_s - start_s, MACHINE_PLACES)
        links = [solid for time_s in some for solid in link_solids(machine, swing.at(float(time_s)))]
    people: tuple[Walker, ...] = ()
    if course.people:
        taken = Taken.of(around.floor.grid, around.solids, around.surfaces)
        taken = taken.with_more(Taken.of(taken.grid, [*links, *_housings(around.eyes_m)]).grown(SPARE_M))
        nearest_s = start_s + NEAREST_AT * (end_s - start_s)
        people = walkers(course.people, around.floor, taken, _past(around, links), nearest_s)
    return Scene(around.fixed, machine, swing, people, start_s, notes)


def _swing(around: Surroundings, machine: Machine | None, course: Course) -> tuple[Swing, tuple[str, ...]]:
    if machine is None:
        return Swing.still({}), ()
    if course.joints is None:
        everywhere = _postures(around, machine, around.box.lower_m, around.box.upper_m)
        middle = everywhere.usual(np.random.default_rng(course.seed))
    else:
        middle = {name: float(value) for name, value in machine.checked(course.joints).items()}
    still = Swing.still(middle)
    swing = Swing.about(machine, middle, course.speeds) if course.moves else still
    times = [time_s - course.times_s[0] for time_s in course.times_s]
    postures = _postures(around, machine, *_bounds(machine, swing, times))
    trouble = postures.trouble(middle)
    if trouble is not None:
        return swing, (f"at the pose that was given {trouble}",)
    clear = swing.clear_of(postures, times)
    if course.moves and clear.is_still:
        return still, ("the machine stands still: it cannot swing about its pose without touching something",)
    return clear, ()


def _postures(
    around: Surroundings, machine: Machine, lower: NDArray[np.float64], upper: NDArray[np.float64]
) -> Postures:
    """What the machine can do within a part of the box, shape (3,) each [m]."""
    lower, upper = np.maximum(lower, around.box.lower_m), np.minimum(upper, around.box.upper_m)
    if (upper <= lower).any():
        lower, upper = around.box.lower_m, around.box.upper_m
    return Postures(machine, Taken.of(fine_grid(lower, upper), around.solids, around.surfaces), around.box)


def _bounds(
    machine: Machine, swing: Swing, times_s: Sequence[float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and greatest corner of where the machine's links come to be [m]."""
    some = times_s[:: max(1, len(times_s) // MACHINE_PLACES)]
    corners = np.concatenate(
        [link.vertices_in_world for time_s in some for link in link_solids(machine, swing.at(time_s))]
    )
    return corners.min(axis=0) - SPARE_M, corners.max(axis=0) + SPARE_M


def _housings(eyes_m: NDArray[np.float64]) -> list[Solid]:
    cube = join([box((-HOUSING_M / 2,) * 3, (HOUSING_M / 2,) * 3)])
    placed = np.tile(np.eye(4), (len(eyes_m), 1, 1))
    placed[:, :3, 3] = eyes_m
    return [Solid("camera", cube, world_from_camera) for world_from_camera in placed]


def _past(around: Surroundings, links: Sequence[Solid]) -> NDArray[np.float64]:
    """Where the machine will be, or the box's middle, seen from above, shape (n, 2) [m]."""
    if not links:
        return (around.box.lower_m + around.box.upper_m)[None, :2] / 2
    return np.concatenate([link.vertices_in_world[:, :2] for link in links])
