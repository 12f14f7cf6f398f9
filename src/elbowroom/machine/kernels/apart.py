"""How far two triangles, and two links of triangles, are apart: exact."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.rigid import along
from elbowroom.machine.kernels.boxes import Boxes

PARALLEL = 1e-12
"""Edges are parallel whose angle has a sine squared of less than this."""
DEPTH = 256
"""Room for pairs of boxes that are still to be looked at; a look needs no more than twice the depth of both trees."""


@njit(inline="always")
def _less(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(inline="always")
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(inline="always")
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(inline="always")
def _along(a, b, share):
    """The point from a towards b."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])


@njit(inline="always")
def _corner(triangle, n):
    return triangle[n, 0], triangle[n, 1], triangle[n, 2]


@uncounted(error_model="numpy")
def _of_edges(p, q, r, s):
    """The squared distance of two edges, p to q and r to s, and the nearest point of the first.

    Ericson, Real-Time Collision Detection, 2005, 5.1.9.
    """
    u, v, w = _less(q, p), _less(s, r), _less(p, r)
    a, e, f = _dot(u, u), _dot(v, v), _dot(v, w)
    c, b = _dot(u, w), _dot(u, v)
    if a <= 0.0 and e <= 0.0:
        return _dot(w, w), p
    if a <= 0.0:
        x, y = 0.0, min(max(f / e, 0.0), 1.0)
    elif e <= 0.0:
        x, y = min(max(-c / a, 0.0), 1.0), 0.0
    else:
        across = a * e - b * b
        x = min(max((b * f - c * e) / across, 0.0), 1.0) if across > PARALLEL * a * e else 0.0
        y = (b * x + f) / e
        if y < 0.0:
            x, y = min(max(-c / a, 0.0), 1.0), 0.0
        elif y > 1.0:
            x, y = min(max((b - c) / a, 0.0), 1.0), 1.0
    at = _along(p, q, x)
    away = _less(at, _along(r, s, y))
    return _dot(away, away), at


@uncounted(error_model="numpy")
def _above(p, a, b, c):
    """The squared distance of a point from a triangle's inside, straight above or below it; infinity: it is not there.

    Points beside it are nearest to its edges.
    """
    u, v, w = _less(b, a), _less(c, a), _less(p, a)
    n = _cross(u, v)
    size = _dot(n, n)
    if size <= 0.0:
        return math.inf, p
    x, y = _dot(_cross(w, v), n) / size, _dot(_cross(u, w), n) / size
    if x < 0.0 or y < 0.0 or x + y > 1.0:
        return math.inf, p
    high = _dot(w, n)
    at = a[0] + x * u[0] + y * v[0], a[1] + x * u[1] + y * v[1], a[2] + x * u[2] + y * v[2]
    return high * high / size, at


@uncounted(error_model="numpy")
def _pierces(p, q, a, b, c):
    """Whether the edge from p to q goes through a triangle, and where."""
    n = _cross(_less(b, a), _less(c, a))
    high, low = _dot(_less(p, a), n), _dot(_less(q, a), n)
    if (high > 0.0) == (low > 0.0) or high == low:
        return False, p
    at = _along(p, q, high / (high - low))
    for one, two in ((a, b), (b, c), (c, a)):
        if _dot(_cross(_less(two, one), _less(at, one)), n) < 0.0:
            return False, p
    return True, at


@uncounted()
def of_triangles(one, other):
    """The distance of two triangles, (3, 3) each, 0 where they meet, and the nearest point of the first."""
    least, at = math.inf, _corner(one, 0)
    a, b, c = _corner(one, 0), _corner(one, 1), _corner(one, 2)
    d, e, f = _corner(other, 0), _corner(other, 1), _corner(other, 2)
    for p, q in ((a, b), (b, c), (c, a)):
        through, place = _pierces(p, q, d, e, f)
        if through:
            return 0.0, place
        for r, s in ((d, e), (e, f), (f, d)):
            away, place = _of_edges(p, q, r, s)
            if away < least:
                least, at = away, place
    for p, q in ((d, e), (e, f), (f, d)):
        through, place = _pierces(p, q, a, b, c)
        if through:
            return 0.0, place
    for p in (a, b, c):
        away, _ = _above(p, d, e, f)
        if away < least:
            least, at = away, p
    for p in (d, e, f):
        away, place = _above(p, a, b, c)
        if away < least:
            least, at = away, place
    return math.sqrt(least), at


@uncounted()
def _gap_of_boxes(boxes, one, other, b):
    """No more than the distance of two boxes; `b`: the second link's frame from the first's, (3, 4).

    The first box as a box along the second's axes, and the other way about.
    """
    p, q, h, g = boxes.centre, boxes.centre, boxes.half, boxes.half
    x = b[0, 0] * p[one, 0] + b[0, 1] * p[one, 1] + b[0, 2] * p[one, 2] + b[0, 3] - q[other, 0]
    y = b[1, 0] * p[one, 0] + b[1, 1] * p[one, 1] + b[1, 2] * p[one, 2] + b[1, 3] - q[other, 1]
    z = b[2, 0] * p[one, 0] + b[2, 1] * p[one, 1] + b[2, 2] * p[one, 2] + b[2, 3] - q[other, 2]
    there, here = 0.0, 0.0
    for axis in range(3):
        middle = x if axis == 0 else y if axis == 1 else z
        reach = abs(b[axis, 0]) * h[one, 0] + abs(b[axis, 1]) * h[one, 1] + abs(b[axis, 2]) * h[one, 2]
        gap = max(abs(middle) - reach - g[other, axis], 0.0)
        there += gap * gap
        middle = b[0, axis] * x + b[1, axis] * y + b[2, axis] * z
        reach = abs(b[0, axis]) * g[other, 0] + abs(b[1, axis]) * g[other, 1] + abs(b[2, axis]) * g[other, 2]
        gap = max(abs(middle) - reach - h[one, axis], 0.0)
        here += gap * gap
    return math.sqrt(max(there, here))


@uncounted()
def _size(half, box):
    return half[box, 0] + half[box, 1] + half[box, 2]


class Asked(NamedTuple):
    """What is asked of two links.

    Fields:
        near: how near they may come [m].
        met: at this distance they have met; no more than `near`, or twice that [m].
        within: travel that is looked at.
    """

    near: float
    met: float
    within: float


class Room(NamedTuple):
    """Room to work in: pairs of boxes, (DEPTH, 2), and when they are so near, (DEPTH,), a triangle, (3, 3).

    `at` (4,) takes the nearest point of the first link, in the second's frame, and the distance there [m]. `last` (4,):
    the two triangles that came soonest when the same links were looked at last, and their parts; -1: they were not.
    What came soonest mostly does so again: it is looked at first.
    """

    pairs: np.ndarray
    soon: np.ndarray
    triangle: np.ndarray
    at: np.ndarray
    last: np.ndarray


@njit
def room():
    """Room for one thread."""
    return Room(
        np.empty((DEPTH, 2), dtype=np.int64), np.empty(DEPTH), np.empty((3, 3)), np.zeros(4), np.full(4, -1)
    )


@uncounted()
def soonest(boxes, rows, other_from_one, speeds, asked, room):
    """When two links can come as near as `asked.near` at the earliest, each part at its greatest speed.

    Args:
        boxes: of the links.
        rows: of the two links.
        other_from_one: the second link's frame from the first's, (3, 4).
        speeds: of each part of the links [m per unit of travel].
        asked: what is asked (`Asked`).
        room: to work in (`Room`).

    Returns:
        Travel, at most `asked.within`; -1 where links are no farther apart than `asked.met` at what comes first.
    """
    pairs, soon, last = room.pairs, room.soon, room.last
    best = asked.within
    if last[0] >= 0:
        speed = speeds[last[2]] + speeds[last[3]]
        _put(boxes.triangles[last[0]], other_from_one, room.triangle)
        best = _sooner(boxes, (last[0], last[1]), speed, asked, room, best)
        if best < 0.0:
            return best
    pairs[0, 0], pairs[0, 1], soon[0] = boxes.root[rows[0]], boxes.root[rows[1]], 0.0
    left = 1 if pairs[0, 0] >= 0 and pairs[0, 1] >= 0 else 0
    while left > 0:
        left -= 1
        one, other = pairs[left, 0], pairs[left, 1]
        if soon[left] >= best:
            continue
        if boxes.child[one] < 0 and boxes.child[other] < 0:
            best = _soonest_of_triangles(boxes, (one, other), other_from_one, speeds, asked, room, best)
            if best < 0.0:
                return best
            continue
        cut_one = boxes.child[other] < 0 or (
            boxes.child[one] >= 0 and _size(boxes.half, one) >= _size(boxes.half, other)
        )
        begun = left
        for n in range(2):
            a = boxes.child[one] + n if cut_one else one
            b = other if cut_one else boxes.child[other] + n
            gap = max(_gap_of_boxes(boxes, a, b, other_from_one) - asked.near, 0.0)
            speed = speeds[boxes.part[a]] + speeds[boxes.part[b]]
            if gap >= best * speed:
                continue
            when, to = gap / speed, left
            # the sooner of the two is looked at first
            if left > begun and when > soon[begun]:
                pairs[left, 0], pairs[left, 1], soon[left] = pairs[begun, 0], pairs[begun, 1], soon[begun]
                to = begun
            pairs[to, 0], pairs[to, 1], soon[to] = a, b, when
            left += 1
    return best


@uncounted()
def _soonest_of_triangles(boxes, two, other_from_one, speeds, asked, room, best):
    """The same for the triangles of two boxes, where that is sooner than `best`; else `best`."""
    one, other = two
    speed = speeds[boxes.part[one]] + speeds[boxes.part[other]]
    for n in range(boxes.first[one], boxes.stop[one]):
        _put(boxes.triangles[n], other_from_one, room.triangle)
        for m in range(boxes.first[other], boxes.stop[other]):
            before, best = best, _sooner(boxes, (n, m), speed, asked, room, best)
            if best < before:
                room.last[2], room.last[3] = boxes.part[one], boxes.part[other]
            if best < 0.0:
                return best
    return best


@uncounted()
def _put(triangle, other_from_one, moved):
    """Fills a triangle in another link's frame."""
    for corner in range(3):
        x, y, z = _corner(triangle, corner)
        for axis in range(3):
            moved[corner, axis] = along(other_from_one, axis, x, y, z)


@uncounted()
def _sooner(boxes, two, speed, asked, room, best):
    """The same for two triangles, the first of them in `room.triangle`."""
    away, place = of_triangles(room.triangle, boxes.triangles[two[1]])
    gap = max(away - asked.near, 0.0)
    if gap >= best * speed:
        return best
    room.at[0], room.at[1], room.at[2] = place
    room.at[3] = away
    room.last[0], room.last[1] = two
    return -1.0 if away <= asked.met else gap / speed


@njit(cache=True, nogil=True)
def relate(placed, one, other, other_from_one):
    """Fills a transform (3, 4) from a link's frame to another's; `placed`: where links are, (links, 4, 4)."""
    a, b = placed[one], placed[other]
    for i in range(3):
        for j in range(3):
            other_from_one[i, j] = b[0, i] * a[0, j] + b[1, i] * a[1, j] + b[2, i] * a[2, j]
        x, y, z = a[0, 3] - b[0, 3], a[1, 3] - b[1, 3], a[2, 3] - b[2, 3]
        other_from_one[i, 3] = b[0, i] * x + b[1, i] * y + b[2, i] * z


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
        work.last[0] = -1
        away = soonest(bodies.boxes, (one, other), other_from_one, speeds, Asked(0.0, 0.0, within), work)
        apart[pair] = 0.0 if away < 0.0 else away if away < within else math.inf
