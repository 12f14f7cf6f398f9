"""The swept check: the first interval of a motion in which a moving sample meets a blocked voxel."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.motion.kernels.mover import Mover, place_at
from elbowroom.motion.kernels.near import TOGETHER, near_clusters, near_members, near_samples
from elbowroom.motion.kernels.touched import NOTHING, touched_block


class Halvings(NamedTuple):
    """How often an interval is cut in half: so often while clusters are asked, and at most."""

    of_clusters: int
    most: int


class Asked(NamedTuple):
    """What is left to ask at each depth of cutting, a row each, and room to work in.

    Fields:
        clusters: row d is asked at depth d, int32.
        samples: row d is asked d depths deeper than the last of the clusters, int32; row 0 is not used.
        counts: how many are left after each depth, int64.
        corners: of the voxels nearest to some samples, (3, `TOGETHER`) int32.
        triangle: (3, 3).
    """

    clusters: np.ndarray
    samples: np.ndarray
    counts: np.ndarray
    corners: np.ndarray
    triangle: np.ndarray


@njit(cache=True, nogil=True)
def first_block(tree, world_from_base, skin, course, length, speeds, volume, halvings):
    """The first of 2^halvings.most equal intervals of [0, length] in which the machine meets a block.

    An interval is tested at its middle, every ball grown by the most that it moves in half of it (its cluster's
    speed times half its length). Where no ball meets a block the interval is free; else its halves are looked at,
    the earlier one first, with the balls that are left: clusters down to `halvings.of_clusters`, samples from
    there, and in the shortest intervals the samples' triangles.

    Args:
        tree, world_from_base, skin, course, speeds: what moves, and how (`Mover`).
        length: travel that is looked at, at most the course's.
        volume: what is blocked.
        halvings: how often intervals are cut.

    Returns:
        The interval's index, -1 for none; what the block is, the cluster that meets it, and where (3,) [m].
    """
    # made here and not by the caller: a record in a record costs Python more to hand over than what it holds
    mover = Mover(tree, world_from_base, skin, course, speeds)
    asked = _all_moving(mover, halvings)
    placed = np.empty((1, mover.tree.parent.size, 4, 4))
    place = np.zeros(3)
    depth, index = 0, 0
    while True:
        half = length / 2.0 ** (depth + 1)
        place_at(mover, (2 * index + 1) * half, placed)
        left = _ask(placed[0], mover, half, volume, asked, depth, halvings)
        if left > 0 and depth == halvings.most:
            samples = asked.samples[depth - halvings.of_clusters + 1, :left]
            kind, by = touched_block(placed[0], mover, half, volume, samples, place, asked.triangle)
            if kind != NOTHING:
                return index, kind, by, place
        elif left > 0:
            asked.counts[depth] = left
            depth, index = depth + 1, index * 2
            continue
        # on to the later half of the interval that has one which was not looked at
        while index & 1:
            depth, index = depth - 1, index >> 1
        if depth == 0:
            return -1, NOTHING, -1, place
        index += 1


@njit
def _all_moving(mover, halvings):
    """What is asked first, all clusters that move, and room for what is left of them."""
    moving = np.flatnonzero(mover.speeds > 0.0)
    total = 0
    for cluster in moving:
        total += mover.skin.stop[cluster] - mover.skin.start[cluster]
    clusters = np.empty((halvings.of_clusters + 2, moving.size), dtype=np.int32)
    samples = np.empty((halvings.most - halvings.of_clusters + 2, total), dtype=np.int32)
    for n in range(moving.size):
        clusters[0, n] = moving[n]
    counts, corners = np.zeros(halvings.most + 1, dtype=np.int64), np.empty((3, TOGETHER), dtype=np.int32)
    return Asked(clusters, samples, counts, corners, np.empty((3, 3)))


@uncounted()
def _ask(placed, mover, half, volume, asked, depth, halvings):
    """How many of the clusters or samples asked at a depth may meet a block: they are what the next depth asks."""
    row = depth - halvings.of_clusters
    before = asked.clusters.shape[1] if depth == 0 else asked.counts[depth - 1]
    if row > 0:
        samples = asked.samples
        return near_samples(placed, mover, half, volume, samples[row, :before], samples[row + 1])
    near = asked.clusters[depth + 1]
    left = near_clusters(placed, mover, half, volume, asked.clusters[depth, :before], near)
    if row == 0:
        left = near_members(placed, mover, half, volume, near[:left], asked.samples[1], asked.corners)
    return left
