"""The first stop from a path in which a machine may meet itself, where each joint brakes by itself."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.machine.kernels.body import FIXED
from elbowroom.motion.contacts import parts_of
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.beside import Box, Closing, Cutting, pair_in_box
from elbowroom.motion.kernels.meeting import Now, Pairs

FINEST_M = 0.004
"""A box of joint positions is cut until no part of two links moves farther in it [m]."""
MOST_BOXES = 4_000
"""So many parts of one box are looked at; links that are not known to stay apart then have met."""
First = tuple[float, int, NDArray[np.float64]]


def first_stop_meeting(
    machine: Machine, pairs: Pairs, now: Now, way: Way, pair_numbers: NDArray[np.int64]
) -> First:
    """When the first stop is commanded in which two links may meet, which pair it is or -1, and where.

    Args:
        machine: with its things, as `Meeting` has it.
        pairs: of its links.
        now: how far apart they are where the machine stands.
        way: with stops; its length is what is looked at.
        pair_numbers: those that are asked.
    """
    stops, parts = way.stops, parts_of(machine.shape)
    assert stops is not None
    found: First = (way.length, -1, np.zeros(3))
    length = way.length
    cutting = Cutting(FINEST_M, MOST_BOXES)
    for pair in pair_numbers.tolist():
        one, other = int(pairs.bodies.one[pair]), int(pairs.bodies.other[pair])
        top, columns = _between(machine, one, other)
        floor = min(float(now.least[pair] - pairs.doubt[pair]), 0.0)
        met = min(pairs.bodies.met, float(now.apart[pair]) / 2)
        closing = Closing(pair, top, parts, floor, met)

        def look(
            begin_s: float, end_s: float, closing: Closing = closing, columns: NDArray[np.bool_] = columns
        ) -> NDArray[np.float64] | None:
            box, place = stops.box(begin_s, end_s), np.zeros(3)
            box = Box(box.middle, np.where(columns, box.half, 0.0))
            meets = pair_in_box(machine.tree, machine.world_from_base, pairs, closing, box, cutting, place)
            return place if meets else None

        first = stops.first(length, length / 2**12, look)
        if first is not None:
            length, found = first[0], (first[0], pair, first[1])
    return found


def _between(machine: Machine, one: int, other: int) -> tuple[int, NDArray[np.bool_]]:
    """The link up the tree that two links hang on, -1: none, and which joints lie between them, shape (joints,)."""
    tree, columns = machine.tree, np.zeros(len(machine.joint_names), dtype=np.bool_)
    above = _up(machine, one)
    top = next((row for row in _up(machine, other) if row in above), -1)
    for row in (one, other):
        while row >= 0 and row != top:
            if tree.kind[row] != FIXED:
                columns[tree.column[row]] = True
            row = int(tree.parent[row])
    return top, columns


def _up(machine: Machine, row: int) -> list[int]:
    """A link and those above it."""
    rows = []
    while row >= 0:
        rows.append(row)
        row = int(machine.tree.parent[row])
    return rows
