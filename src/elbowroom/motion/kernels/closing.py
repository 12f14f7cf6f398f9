"""When links that are apart come to touch: exact distances, steps as long as they allow (conservative advancement)."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.rigid import moved
from elbowroom.machine.kernels.apart import Asked, relate, room, soonest
from elbowroom.machine.kernels.body import Tree
from elbowroom.machine.kernels.boxes import Boxes
from elbowroom.motion.kernels.mover import Course, place_at


class Bodies(NamedTuple):
    """Links that must not meet, as triangles.

    Fields:
        boxes: of all links.
        one, other: rows of the links of each pair, (pairs,).
        met: links that are as near as that have met [m].
    """

    boxes: Boxes
    one: np.ndarray
    other: np.ndarray
    met: float


class Travelling(NamedTuple):
    """A machine on its way: its tree and where its base stands, (4, 4), where it goes, and the most that each part of
    its links moves per unit of travel, (parts,) [m]."""

    tree: Tree
    world_from_base: np.ndarray
    course: Course
    speeds: np.ndarray


@njit(cache=True, nogil=True)
def apart_now(bodies, placed, within, apart):
    """Fills the distance of each pair, (pairs,) [m]; infinity: more than `within`.

    Args:
        bodies: what must not meet.
        placed: where links are, (links, 4, 4).
        within: what is farther apart does not matter [m].
        apart: takes the distances.
    """
    other_from_one, work = np.empty((3, 4)), room()
    speeds = np.full(bodies.boxes.part.max() + 1, 0.5)
    for pair in range(apart.size):
        one, other = bodies.one[pair], bodies.other[pair]
        relate(placed, one, other, other_from_one)
        away = soonest(bodies.boxes, (one, other), other_from_one, speeds, Asked(0.0, 0.0, within), work)
        apart[pair] = 0.0 if away < 0.0 else away if away < within else math.inf


@njit(cache=True, nogil=True)
def first_touch(mover, bodies, length, apart, moving):
    """The travel up to which no pair touches, the pair that touches after it or -1, and where, (3,) [m].

    A pair has met at `bodies.met` apart. Steps end where no more than half of that is left, so nothing meets between
    two looks. A pair that is as near as that already has met at half of what it is apart.

    Args:
        mover: what moves, and how (`Travelling`).
        bodies: what must not meet.
        length: travel that is looked at, at most the course's.
        apart: now, of `apart_now`; at 0 a pair touches already, and is none that is looked at here.
        moving: whether the links of each pair move against each other.
    """
    place, found, limit = np.zeros(3), -1, length
    placed, other_from_one, work = np.empty((1, mover.tree.parent.size, 4, 4)), np.empty((3, 4)), room()
    start = np.empty_like(placed)
    place_at(mover, 0.0, start)
    for pair in range(apart.size):
        if not moving[pair] or apart[pair] <= 0.0:
            continue
        rows = bodies.one[pair], bodies.other[pair]
        met = min(bodies.met, apart[pair] / 2)
        fastest = _fastest(mover.speeds, bodies.boxes, rows[0]) + _fastest(
            mover.speeds, bodies.boxes, rows[1]
        )
        known, travel, here = 0.0, 0.0, start
        while True:
            relate(here[0], rows[0], rows[1], other_from_one)
            asked = Asked(met / 2, met, limit - travel)
            step = soonest(bodies.boxes, rows, other_from_one, mover.speeds, asked, work)
            if step < 0.0:
                found, limit = pair, known
                x, y, z = moved(here[0, rows[1]], work.at[0], work.at[1], work.at[2])
                place[0], place[1], place[2] = x, y, z
                break
            known = travel
            travel += max(step, met / 4 / fastest) if fastest > 0.0 else limit
            if not travel < limit:
                break
            here = placed
            place_at(mover, travel, here)
        if limit <= 0.0:
            break
    return limit, found, place


@njit
def _fastest(speeds, boxes, row):
    """The speed of a link's fastest part, 0 without a body: its tree's first box is all of it."""
    root = boxes.root[row]
    return speeds[boxes.part[root]] if root >= 0 else 0.0
