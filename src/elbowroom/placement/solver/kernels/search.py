"""What the search asks of a layout again and again: views apart at each point, and what one camera more would add."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

TURN = 2.0 * math.pi


class Sights(NamedTuple):
    """Which points candidates see, and from where.

    Fields:
        sees: uint8, shape (candidates, points).
        azimuth: shape (places, points) [rad]; NaN: no direction.
        place_of: place of each candidate.
    """

    sees: np.ndarray
    azimuth: np.ndarray
    place_of: np.ndarray


class Apart(NamedTuple):
    """When views are far enough apart.

    Fields:
        angle, tie: least angle, and by how much less still counts [rad].
        most: more views than these are not looked for.
    """

    angle: float
    tie: float
    most: int


@njit(cache=True, nogil=True)
def reach_from(angles, m, start, rule):
    """How many of m directions, one of them `start`, can be taken pairwise at least `rule.angle` apart.

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
            if turn >= way + rule.angle - rule.tie and turn < nearest:
                nearest = turn
        if nearest > TURN - rule.angle + rule.tie:
            return taken
        taken += 1
        way = nearest


@njit(cache=True, nogil=True)
def apart_of_points(sights, chosen, rule, points, apart):
    """Fills apart[p] for the given points: size of the largest set of views far enough apart, no more than `rule.most`.

    Args:
        sights: of all candidates.
        chosen: candidates of the layout.
        rule: when views are far enough apart.
        points: indices of the points that are asked.
        apart: uint8, shape (points,), written.
    """
    angles = np.empty(len(chosen))
    for p in points:
        m, seen = _directions(sights, chosen, p, angles)
        best = 1 if seen else 0
        if m >= 2 and rule.most >= 2:
            for n in range(m):
                best = max(best, reach_from(angles, m, angles[n], rule))
                if best >= rule.most:
                    break
        apart[p] = min(best, rule.most)


@njit(nogil=True)
def _directions(sights, chosen, p, angles):
    """Writes the directions from which chosen candidates see a point; how many, and whether any sees it at all."""
    m, seen = 0, False
    for c in chosen:
        if sights.sees[c, p]:
            seen = True
            direction = sights.azimuth[sights.place_of[c], p]
            # one straight above has none, NaN
            if direction == direction:
                angles[m] = direction
                m += 1
    return m, seen


@njit(cache=True, nogil=True)
def gains(sights, chosen, rule, points, apart, worth, gain):
    """Adds up what each candidate, added to a layout, would improve at the given points.

    Args:
        worth: value of a point by its views apart, shape (rule.most + 1,).
        gain: shape (candidates,), written.
        The others as of `apart_of_points`.
    """
    sees, azimuth, place_of = sights.sees, sights.azimuth, sights.place_of
    angles = np.empty(len(chosen) + 1)
    # by place, as all candidates of one place have the same direction; below zero: not worked out yet
    better = np.empty(azimuth.shape[0])
    gain[:] = 0.0
    for p in points:
        if apart[p] >= rule.most:
            continue
        m, _ = _directions(sights, chosen, p, angles)
        here = worth[apart[p]]
        better[:] = -1.0
        for c in range(sees.shape[0]):
            if not sees[c, p]:
                continue
            place = place_of[c]
            if better[place] < 0.0:
                start = azimuth[place, p]
                size = reach_from(angles, m, start, rule) if start == start else 1
                better[place] = max(worth[min(size, rule.most)] - here, 0.0)
            gain[c] += better[place]


@njit(cache=True, nogil=True)
def losses(sights, chosen, rule, apart, worth, loss):
    """What each member of a layout is worth: by how much the points' values would fall without it.

    Args:
        loss: shape (len(chosen),), written.
        The others as of `gains`, with all points.
    """
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
        for p in range(sights.sees.shape[1]):
            if sights.sees[chosen[n], p] and apart[p] > 0:
                one[0] = p
                apart_of_points(sights, rest, rule, one, without)
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
