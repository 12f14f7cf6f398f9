"""Moves of one joint after the other that touch nothing that stands in the room."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Machine
from elbowroom.simulate import InterventionRoom, Moment, true_occupancy
from elbowroom.simulate.machine_solids import course, link_solids

VOXEL_M = 0.04
"""Of the volume in which moves are looked for [m]."""
REACH = {"long": 0.3, "larm": 1.0, "propeller": 0.9, "carc": 0.7}
"""How far a joint goes in one move at most [m or rad]."""
AS_FAR_AS_THERE_IS_ROOM = 0.6
"""This share of the moves ends right beside what is taken; the others somewhere before."""
LEAST_STEPS = 3
"""A shorter move is none."""
STEP_M = 0.06
"""A move is looked at so often that no point goes farther in between [m]."""
LEVER_M = 1.2
TRIES = 4000


@dataclass(frozen=True, slots=True)
class Move:
    """One joint goes from one pose to another.

    Args:
        start, end: numbers of the poses.
        joint: its name.
    """

    start: int
    end: int
    joint: str


@dataclass(frozen=True, slots=True, eq=False)
class Moves:
    """Poses, and the moves between them, there and back.

    Args:
        poses: joint positions by name [m or rad].
        moves: in both directions.
    """

    poses: Sequence[Mapping[str, float]]
    moves: Sequence[Move]

    def after(self, pose: int) -> list[Move]:
        """What can be done from a pose."""
        return [move for move in self.moves if move.start == pose]


def find_moves(machine: Machine, count: int, rng: np.random.Generator) -> Moves:
    """A tree of moves of which none touches furniture.

    Args:
        machine: in the simulated room.
        count: how many moves, there and back counted once.
        rng: source of randomness.

    Raises:
        InputError: so many were not found.
    """
    taken = true_occupancy(_grid(), InterventionRoom(staff=()).at(0.0)).occupied
    poses, moves = [course(machine, 0.0)], list[Move]()
    for _ in range(TRIES):
        if len(moves) == 2 * count:
            return Moves(poses, moves)
        start = int(rng.integers(len(poses)))
        joint, way = str(rng.choice(list(REACH))), float(rng.choice((-1.0, 1.0)))
        step = way * STEP_M / (1.0 if machine.joint(joint).unit == "m" else LEVER_M)
        free = _free_steps(machine, poses[start], joint, step, taken)
        steps = free if rng.random() < AS_FAR_AS_THERE_IS_ROOM else int(rng.integers(0, free + 1))
        if steps < LEAST_STEPS:
            continue
        poses.append({**poses[start], joint: poses[start][joint] + steps * step})
        end = len(poses) - 1
        moves += [Move(start, end, joint), Move(end, start, joint)]
    raise InputError(f"lag: {len(moves) // 2} moves that touch nothing were found, {count} are needed")


def _grid() -> VoxelGrid:
    return VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), VOXEL_M)


def _free_steps(
    machine: Machine, start: Mapping[str, float], joint: str, step: float, taken: NDArray[np.bool_]
) -> int:
    """How many steps a joint can go from a pose, as far as it may, before the machine meets what is taken."""
    limits = machine.joint(joint)
    for n in range(1, int(REACH[joint] / abs(step)) + 1):
        value = start[joint] + n * step
        joints = {**start, joint: value}
        there = (
            Moment(0.0, link_solids(machine, joints), joints) if limits.lower < value < limits.upper else None
        )
        if there is None or (true_occupancy(_grid(), there).machine & taken).any():
            return n - 1
    return int(REACH[joint] / abs(step))
