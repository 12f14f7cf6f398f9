"""Triangles of links in trees of boxes: what lies far from a place is passed over together."""

from typing import NamedTuple

import numpy as np
from numba import njit

LEAF = 1
"""A box of no more triangles is not cut further."""


class Boxes(NamedTuple):
    """The triangles of links, each link's in a tree of boxes along the axes of its frame [m].

    Fields:
        triangles: of all links, (m, 3, 3), link frame; those of a box lie one after another.
        centre, half: of each box, (boxes, 3).
        child: the first of the two boxes that a box is cut into, the other follows it; -1: it is not cut.
        first, stop: the triangles of each box, `stop` exclusive.
        part: of each box, the part of its link that it lies in; all of a part counts as equally fast.
        link: the row of the link of each box.
        root: the box of each link, (links,); -1: it has no body.
    """

    triangles: np.ndarray
    centre: np.ndarray
    half: np.ndarray
    child: np.ndarray
    first: np.ndarray
    stop: np.ndarray
    part: np.ndarray
    link: np.ndarray
    root: np.ndarray


@njit(cache=True, nogil=True)
def cut(triangles, order, centre, half, child, first, stop):
    """Fills the tree of one link's triangles, (m, 3, 3), and the order in which they lie in it; how many boxes it has.

    A box is cut at the median of its triangles along its longest side.

    Args:
        triangles: of the link.
        order: (m,), takes the triangles' numbers.
        centre, half, child, first, stop: as of `Boxes`, at least 2 m long.
    """
    middle = np.empty((len(triangles), 3))
    for n in range(len(triangles)):
        order[n] = n
        for axis in range(3):
            a, b, c = triangles[n, 0, axis], triangles[n, 1, axis], triangles[n, 2, axis]
            middle[n, axis] = (min(a, b, c) + max(a, b, c)) / 2
    first[0], stop[0] = 0, len(triangles)
    count, box = 1, 0
    while box < count:
        longest = _hold(triangles, order[first[box] : stop[box]], centre[box], half[box])
        child[box] = -1
        if stop[box] - first[box] > LEAF:
            own = order[first[box] : stop[box]].copy()
            places = np.empty(own.size)
            for n in range(own.size):
                places[n] = middle[own[n], longest]
            order[first[box] : stop[box]] = own[np.argsort(places)]
            between = (first[box] + stop[box]) // 2
            child[box] = count
            first[count], stop[count] = first[box], between
            first[count + 1], stop[count + 1] = between, stop[box]
            count += 2
        box += 1
    return count


@njit
def _hold(triangles, own, centre, half):
    """Fills the box that holds some triangles; its longest side."""
    longest = 0
    for axis in range(3):
        low, high = np.inf, -np.inf
        for n in own:
            for corner in range(3):
                low = min(low, triangles[n, corner, axis])
                high = max(high, triangles[n, corner, axis])
        centre[axis], half[axis] = (low + high) / 2, (high - low) / 2
        if half[axis] > half[longest]:
            longest = axis
    return longest
