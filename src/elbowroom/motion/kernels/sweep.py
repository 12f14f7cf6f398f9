"""The swept check: the first interval of a motion in which a moving sample meets a blocked voxel."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.motion.kernels.mover import Mover, place_at
from elbowroom.motion.kernels.near import TOGETHER, near_boxes, near_members, near_samples
from elbowroom.motion.kernels.touched import NOTHING, list_touched, touched_block

MOST_MET = 64
"""So many voxels that are met in one interval are told."""


class Turns(NamedTuple):
    """How joints change in an interval.

    Fields:
        rates: the most of each joint per unit of travel, (joints,).
        half: the most in half of the interval that is looked at, (joints,), written.
        shortest: half of the shortest interval that is looked at, as travel.
        ways: (rows of a tree, 3), room to work in.
    """

    rates: np.ndarray
    half: np.ndarray
    shortest: float
    ways: np.ndarray


class Asked(NamedTuple):
    """What is left to ask at each depth of cutting, a row each, where a sweep has got to, and room to work in.

    Fields:
        clusters: row d is asked at depth d, int32.
        samples: row d is asked d depths deeper than the last of the clusters, int32; row 0 is not used.
        counts: how many are left after each depth, int64.
        at: the depth, and the interval there, that is looked at next, (2,) int64.
        corners: of the voxels nearest to some samples, (3, `TOGETHER`) int32.
        triangle: (3, 3).
    """

    clusters: np.ndarray
    samples: np.ndarray
    counts: np.ndarray
    at: np.ndarray
    corners: np.ndarray
    triangle: np.ndarray


@njit(cache=True, nogil=True)
def to_ask(skin, speeds, of_clusters, most):
    """What is asked first, all clusters that move, and room for what is left of them.

    Args:
        skin: of what moves.
        speeds: of its clusters.
        of_clusters, most: how often an interval is cut in half while clusters are asked, and at most.
    """
    moving = np.flatnonzero(speeds > 0.0)
    total = 0
    for cluster in moving:
        total += skin.stop[cluster] - skin.start[cluster]
    clusters = np.empty((of_clusters + 2, moving.size), dtype=np.int32)
    samples = np.empty((most - of_clusters + 2, total), dtype=np.int32)
    for n in range(moving.size):
        clusters[0, n] = moving[n]
    counts, at = np.zeros(most + 1, dtype=np.int64), np.zeros(2, dtype=np.int64)
    return Asked(clusters, samples, counts, at, np.empty((3, TOGETHER), dtype=np.int32), np.empty((3, 3)))


@njit(cache=True, nogil=True)
def first_block(tree, world_from_base, skin, course, length, speeds, volume, asked):
    """The first of 2^most equal intervals of [0, length] in which the machine meets a block.

    An interval is tested at its middle, all that is asked grown by the most that it moves in half of it: boxes about
    clusters along each axis, balls about samples by their cluster's speed times half its length. Where none meets a
    block the interval is free; else its halves are looked at, the earlier one first, with what is left: clusters first,
    then samples, and in the shortest intervals the samples' triangles, which decide alone. Where it found a block it
    goes on when it is called again.

    Args:
        tree, world_from_base, skin, course, speeds: what moves, and how (`Mover`).
        length: travel that is looked at, at most the course's.
        volume: what is blocked.
        asked: of `to_ask`; or of an earlier call, with a volume of which this one is a part: changed.

    Returns:
        The interval's index, -1 for none; what the block is, the cluster that meets it, where (3,) [m], and the numbers
        of all blocked voxels that are met in that interval, `MOST_MET` at most.
    """
    # made here and not by the caller: a record in a record costs Python more to hand over than what it holds
    mover = Mover(tree, world_from_base, skin, course, speeds)
    of_clusters, most = asked.clusters.shape[0] - 2, asked.counts.size - 1
    placed = np.empty((1, mover.tree.parent.size, 4, 4))
    place, rates = np.zeros(3), _rates(course)
    turns = Turns(rates, np.empty_like(rates), length / 2.0 ** (most + 1), np.empty((placed.shape[1], 3)))
    depth, index = asked.at[0], asked.at[1]
    while True:
        half = length / 2.0 ** (depth + 1)
        place_at(mover, (2 * index + 1) * half, placed)
        left = _ask(placed[0], mover, half, volume, asked, depth, turns)
        if left > 0 and depth == most:
            samples = asked.samples[depth - of_clusters + 1, :left]
            kind, by = touched_block(placed[0], mover, half, volume, samples, place, asked.triangle)
            if kind != NOTHING:
                asked.at[0], asked.at[1] = depth, index
                met = np.empty(MOST_MET, dtype=np.int64)
                count = list_touched(placed[0], mover, half, volume, samples, asked.triangle, met)
                return index, kind, by, place, met[:count]
        elif left > 0:
            asked.counts[depth] = left
            depth, index = depth + 1, index * 2
            continue
        # on to the later half of the interval that has one which was not looked at
        while index & 1:
            depth, index = depth - 1, index >> 1
        if depth == 0:
            return -1, NOTHING, -1, place, np.empty(0, dtype=np.int64)
        index += 1


@njit
def _rates(course):
    """The most that each joint changes per unit of a course's travel, (joints,)."""
    rates = np.zeros(course.positions.shape[1])
    for knot in range(course.travel.size - 1):
        step = course.travel[knot + 1] - course.travel[knot]
        for joint in range(rates.size):
            change = abs(course.positions[knot + 1, joint] - course.positions[knot, joint])
            rates[joint] = max(rates[joint], change / step)
    return rates


@uncounted()
def _ask(placed, mover, half, volume, asked, depth, turns):
    """How many of the clusters or samples asked at a depth may meet a block: they are what the next depth asks."""
    row = depth - (asked.clusters.shape[0] - 2)
    before = asked.clusters.shape[1] if depth == 0 else asked.counts[depth - 1]
    if row > 0:
        samples = asked.samples
        return near_samples(placed, mover, half, volume, samples[row, :before], samples[row + 1])
    near = asked.clusters[depth + 1]
    for joint in range(turns.half.size):
        turns.half[joint] = turns.rates[joint] * half
    clusters = asked.clusters[depth, :before]
    left = near_boxes(placed, mover, turns.half, turns.shortest, volume, clusters, near, turns.ways)
    if row == 0:
        left = near_members(placed, mover, half, volume, near[:left], asked.samples[1], asked.corners)
    return left
