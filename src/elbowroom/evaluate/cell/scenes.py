"""Moments of a cell: poses of its machine that touch nothing, drawn at random or at work, and a person beside it."""

import itertools
from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.evaluate.cell.cell import Cell
from elbowroom.geometry import VoxelGrid
from elbowroom.simulate import Moment, Solid
from elbowroom.simulate.machine_solids import link_solids
from elbowroom.simulate.person import Person, Stance, Walk
from elbowroom.simulate.postures import Postures
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.taken import Taken, fine_grid

Kind = Literal["random", "work"]
TRIES = 400
HOUSING_M = 0.3
"""A camera takes so much space, with what is right before it [m]."""
PERSON_WITHIN_M = 1.5
"""A person stands within this of the machine's base, seen from above [m]."""
WORK_PAN_RAD = np.pi
WORK_LIFT_RAD = (-2.2, -0.7)
WORK_ELBOW_RAD = (0.7, 2.3)
WORK_SPREAD_RAD = 0.3
"""At work the upper arm of a UR5 stands up, its elbow is bent, and its tool points down, give or take this."""
LARGEST_M = 0.04
"""People and machine are kept apart by voxels of this edge at most [m]."""


class Drawn(NamedTuple):
    """A moment and of what kind the machine's pose is."""

    kind: Kind
    moment: Moment


def cell_scenes(cell: Cell, seed: int, kinds: tuple[Kind, ...]) -> Iterator[Drawn]:
    """Moments of a cell without end, kinds of poses in turn.

    Args:
        cell: what is measured.
        seed: of poses and people.
        kinds: of poses.

    Raises:
        InputError: no pose that touches nothing, or no place for a person.
    """
    fixed = cell.room.solids
    grid = fine_grid(cell.grid.lower_m, cell.grid.upper_m)
    postures = Postures(cell.machine, Taken.of(grid, fixed, cell.room.surfaces), cell.grid)
    for number in itertools.count():
        rng, kind = np.random.default_rng([seed, number]), kinds[number % len(kinds)]
        joints = postures.drawn(rng) if kind == "random" else _at_work(postures, rng)
        links = link_solids(cell.machine, joints)
        yield Drawn(
            kind,
            Moment(float(number), (*fixed, *cell.room.surfaces, *_person(cell, links, rng), *links), joints),
        )


def _at_work(postures: Postures, rng: np.random.Generator) -> dict[str, float]:
    """A UR5's pose with the tool down over what is before it.

    Raises:
        InputError: another machine, or none was found that touches nothing.
    """
    names = postures.machine.joint_names
    if len(names) != 6:
        raise InputError(f"cell: poses at work are known of arms like a UR5, {postures.machine.name} is none")
    for _ in range(TRIES):
        pan = rng.uniform(-WORK_PAN_RAD, WORK_PAN_RAD)
        lift, elbow = rng.uniform(*WORK_LIFT_RAD), rng.uniform(*WORK_ELBOW_RAD)
        tilt = rng.uniform(-WORK_SPREAD_RAD, WORK_SPREAD_RAD, 3)
        wrist = (-np.pi / 2 - lift - elbow + tilt[0], -np.pi / 2 + tilt[1], tilt[2])
        joints = {name: float(value) for name, value in zip(names, (pan, lift, elbow, *wrist), strict=True)}
        if postures.trouble(joints) is None:
            return joints
    raise InputError(
        f"cell: no pose at work of {postures.machine.name} that touches nothing in {TRIES} tries"
    )


def _person(cell: Cell, links: tuple[Solid, ...], rng: np.random.Generator) -> tuple[Solid, ...]:
    """Somebody who stands beside the machine and touches neither it nor a camera nor what stands there.

    Raises:
        InputError: no place was found.
    """
    base = np.asarray(cell.machine.world_from_base)[:2, 3]
    lower, upper = _floor(cell, base)
    edge = max(LARGEST_M, cell.grid.voxel_size_m)
    taken = Taken.of(VoxelGrid.covering(lower, upper, edge), [*_standing(cell), *links, *_housings(cell)])
    person = Person("person", Walk((0.0, 0.0), (0.1, 0.1), 1.0), round(float(rng.uniform(1.6, 1.95)), 2), 1.0)
    for _ in range(TRIES):
        x, y = rng.uniform(lower[:2], upper[:2])
        heading, phase = rng.uniform(-np.pi, np.pi), rng.uniform(0, 2 * np.pi)
        stance = Stance(float(x), float(y), float(heading), float(phase))
        solids = person.solids(stance)
        near = np.hypot(x - base[0], y - base[1]) < PERSON_WITHIN_M
        if near and not any(taken.meets(solid) for solid in solids):
            return tuple(solids)
    raise InputError(f"cell: no place for a person within {PERSON_WITHIN_M} m in {TRIES} tries")


def _floor(cell: Cell, base: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and greatest corner of where a person may be, from floor to head height [m]."""
    lower, upper = np.array([*(base - PERSON_WITHIN_M), 0.0]), np.array([*(base + PERSON_WITHIN_M), 2.1])
    walls = cell.room.walls_m
    if walls is None:
        return lower, upper
    return np.maximum(lower, walls[0] + [0.3, 0.3, 0.0]), np.minimum(upper, walls[1] - [0.3, 0.3, 0.0])


def _standing(cell: Cell) -> list[Solid]:
    """Furniture: all that is fixed but the shell of the room."""
    return [solid for solid in cell.room.solids if not solid.name.startswith(("wall", "floor", "ceiling"))]


def _housings(cell: Cell) -> list[Solid]:
    cube = join([box((-HOUSING_M / 2,) * 3, (HOUSING_M / 2,) * 3)])
    placed = np.tile(np.eye(4), (len(cell.cameras), 1, 1))
    placed[:, :3, 3] = [camera.centre_in_world for camera in cell.cameras]
    return [Solid(camera.name, cube, pose) for camera, pose in zip(cell.cameras, placed, strict=True)]
