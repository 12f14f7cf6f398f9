"""What the search asks of a layout again and again: views apart at each point, and what one camera more would add."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

TURN = 2.0 * math.pi


class Sights(NamedTuple):
    """What candidates see, and what is asked of the views of a point.

    Fields:
        sees: uint8, shape (candidates, points).
        azimuth: shape (places, points) [rad]; NaN: no direction.
        place_of: place of each candidate.
        angle, tie: least angle between two views, and by how much less still counts [rad].
        most: more views apart are not looked for.
    """

    sees: np.ndarray
    azimuth: np.ndarray
    place_of: np.ndarray
    angle: float
    tie: float
    most: int


@njit(cache=True, nogil=True)
def reach_from(angles, m, start, angle, tie):
    """How many of m directions, one of them `start`, can be taken pairwise at least `angle` apart.

    From each one taken, the nearest counter-clockwise that is far enough is taken next, until too little is left
    before `start` comes round again.
    """
    taken = 1
    way = 0.0
    while True:
        nearest = np.inf
        for n in range(m):
            turn = angles[n] - start
            if turn < 0.0:
                turn += TURN
            if turn >= way + angle - tie and turn < nearest:
                nearest = turn
        if nearest > TURN - angle + tie:
            return taken
        taken += 1
        way = nearest


@njit(cache=True, nogil=True)
def apart_of_points(sights, chosen, points, apart):
    """Fills apart[p] for the given points: size of the largest set of views far enough apart, no more than `most`.

    Args:
        sights: `Sights`.
        chosen: candidates of the layout.
        points: indices of the points that are asked.
        apart: uint8, shape (points,), written.
    """
    sees, azimuth, place_of, angle, tie, most = sights
    angles = np.empty(len(chosen))
    for p in points:
        m = 0
        above = 0
        for c in chosen:
            if sees[c, p]:
                direction = azimuth[place_of[c], p]
                if direction == direction:
                    angles[m] = direction
                    m += 1
                else:
                    above = 1
        best = 1 if m > 0 else above
        if m >= 2 and most >= 2:
            for n in range(m):
                size = reach_from(angles, m, angles[n], angle, tie)
                if size > best:
                    best = size
                    if best >= most:
                        break
        apart[p] = min(best, most)


@njit(cache=True, nogil=True)
def gains(sights, chosen, points, apart, worth, gain):
    """Adds up what each candidate, added to a layout, would improve at the given points.

    Args:
        worth: value of a point by its views apart, shape (most + 1,).
        gain: shape (candidates,), written.
        The others as of `apart_of_points`.
    """
    sees, azimuth, place_of, angle, tie, most = sights
    candidates = sees.shape[0]
    places = azimuth.shape[0]
    angles = np.empty(len(chosen) + 1)
    better = np.empty(places)
    gain[:] = 0.0
    for p in points:
        if apart[p] >= most:
            continue
        m = 0
        for c in chosen:
            if sees[c, p]:
                direction = azimuth[place_of[c], p]
                if direction == direction:
                    angles[m] = direction
                    m += 1
        here = worth[apart[p]]
        better[:] = -1.0
        for c in range(candidates):
            if not sees[c, p]:
                continue
            place = place_of[c]
            if better[place] < 0.0:
                start = azimuth[place, p]
                size = 1
                if start == start:
                    size = reach_from(angles, m, start, angle, tie)
                size = min(size, most)
                better[place] = max(worth[size] - here, 0.0)
            gain[c] += better[place]


@njit(cache=True, nogil=True)
def losses(sights, chosen, apart, worth, loss):
    """What each member of a layout is worth: by how much the points' values would fall without it.

    Args:
        loss: shape (len(chosen),), written.
        The others as of `gains`, with all points.
    """
    sees = sights.sees
    loss[:] = 0.0
    one = np.empty(1, np.int64)
    rest = np.empty(len(chosen) - 1, np.int64)
    without = apart.copy()
    for n in range(len(chosen)):
        at = 0
        for k in range(len(chosen)):
            if k != n:
                rest[at] = chosen[k]
                at += 1
        for p in range(sees.shape[1]):
            if sees[chosen[n], p] and apart[p] > 0:
                one[0] = p
                apart_of_points(sights, rest, one, without)
                loss[n] += worth[apart[p]] - worth[without[p]]


@njit(cache=True, nogil=True)
def least_arcs(angles, order, weight, m, lengths, starts, sums):
    """For each length the arc of that length over which weights at m sorted directions add up to least.

    Args:
        angles: directions in [0, 2 pi), shape (n,) [rad].
        order: their order, shape (n,); the first m of it are used.
        weight: at each direction, shape (n,).
        lengths: of the arcs, closed at both ends [rad].
        starts: shape (len(lengths),), written: where the arc begins [rad].
        sums: shape (len(lengths),), written.
    """
    for j in range(len(lengths)):
        sums[j] = np.inf
        starts[j] = 0.0
        for n in range(m):
            # an arc that begins just behind a direction: it holds what comes next, and not that one
            begin = angles[order[n]] + 1e-7
            total = 0.0
            for k in range(m):
                turn = angles[order[k]] - begin
                if turn < 0.0:
                    turn += TURN
                if turn <= lengths[j]:
                    total += weight[order[k]]
            if total < sums[j]:
                sums[j] = total
                starts[j] = begin
        if m == 0:
            sums[j] = 0.0
