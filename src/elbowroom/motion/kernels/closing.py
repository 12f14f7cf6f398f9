"""When links that are apart come to touch: exact distances, steps as long as they allow (conservative advancement)."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.rigid import moved
from elbowroom.machine.kernels.apart import Asked, Room, relate, room, soonest
from elbowroom.machine.kernels.body import Tree
from elbowroom.motion.kernels.mover import Course, place_at


class Travelling(NamedTuple):
    """A machine on its way: its tree and where its base stands, (4, 4), where it goes, and the most that each part of
    its links moves per unit of travel, (parts,) [m]."""

    tree: Tree
    world_from_base: np.ndarray
    course: Course
    speeds: np.ndarray


class Space(NamedTuple):
    """To work in: where links are, (1, links, 4, 4), a transform, (3, 4), and room for looks."""

    placed: np.ndarray
    other_from_one: np.ndarray
    room: Room


@njit
def space(links):
    """Space for one thread and so many links."""
    return Space(np.empty((1, links, 4, 4)), np.empty((3, 4)), room())


@njit
def touch(mover, bodies, pair, met, span, work, place):
    """The travel up to which a pair does not touch, -1 where it does not at all.

    It has met at `met` apart. Steps end where no more than half of that is left, so nothing meets between two looks.

    Args:
        mover: what moves, and how (`Travelling`).
        bodies: what must not meet.
        pair: of them; it is apart where `span` begins.
        met: how near [m].
        span: travels between which it is looked at.
        work: to work in (`Space`).
        place: (3,), takes where they touch [m].
    """
    rows = bodies.one[pair], bodies.other[pair]
    fastest = _fastest(mover.speeds, bodies.boxes, rows[0]) + _fastest(mover.speeds, bodies.boxes, rows[1])
    travel, end = span
    sure = travel
    work.room.last[0] = -1
    while travel < end:
        place_at(mover, travel, work.placed)
        here = work.placed[0]
        relate(here, rows[0], rows[1], work.other_from_one)
        asked = Asked(met / 2, met, end - travel)
        step = soonest(bodies.boxes, rows, work.other_from_one, mover.speeds, asked, work.room)
        if step < 0.0:
            at = work.room.at
            x, y, z = moved(here[rows[1]], at[0], at[1], at[2])
            place[0], place[1], place[2] = x, y, z
            return sure
        least = met / 4 / fastest if fastest > 0.0 else end
        # a step that its distance allows ends where links are apart
        sure = travel if step < least else travel + step
        travel += max(step, least)
    return -1.0


@njit
def _fastest(speeds, boxes, row):
    """The speed of a link's fastest part, 0 without a body: its tree's first box is all of it."""
    root = boxes.root[row]
    return speeds[boxes.part[root]] if root >= 0 else 0.0
