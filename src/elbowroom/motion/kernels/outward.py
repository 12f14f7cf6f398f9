"""How far a body's surface moves outward within some boxes: what it covers there that it did not cover before."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.triangle import normal_of
from elbowroom.machine.kernels.body import Tree
from elbowroom.motion.kernels.mover import ROUNDING_M, Course, carried, place_at
from elbowroom.motion.kernels.triangles import triangle_meets_box
from elbowroom.motion.kernels.volume import gap

PARTS = 4
"""Along each axis of a box."""
CORNERS = 12
"""A triangle cut by a box has no more."""


class Moves(NamedTuple):
    """A machine on its way: its tree, where its base stands, (4, 4), and where it goes."""

    tree: Tree
    world_from_base: np.ndarray
    course: Course


class Faces(NamedTuple):
    """Triangles of a surface, m of them, in g groups that lie close together.

    Fields:
        triangles: link frame [m], (m, 3, 3); outward is the way of their normals, by the right hand.
        sharp: how much faster an edge or a corner of it may go outward than the triangles that meet there, (m,).
        sided: whether it is known which way is outward, (m,) bool; if not, every way is.
        start, stop: of each group, (g,).
        link: of each group, (g,).
        centre, radius: of a ball about each group, (g, 3) and (g,), link frame [m].
    """

    triangles: np.ndarray
    sharp: np.ndarray
    sided: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    link: np.ndarray
    centre: np.ndarray
    radius: np.ndarray


class Boxes(NamedTuple):
    """Cubes, n of them.

    Fields:
        corner: the least of each, (n, 3) [m].
        edge: of all [m].
        parts: of each those that count, one bit for each of 4 x 4 x 4, (n,) uint64.
        links: whose surface is asked about in each, (n, links) bool.
    """

    corner: np.ndarray
    edge: float
    parts: np.ndarray
    links: np.ndarray


@njit(cache=True, nogil=True)
def first_outward(moves, faces, boxes, at, rates, most):
    """The first interval of a way by whose end a surface may have moved outward by more than some length.

    What is not covered at the start, and farther from the body than that length, is nowhere covered in these boxes
    before that interval: the distance of a point from the body shrinks no faster than the body's nearest place moves
    outward, and that place lies in the point's box, grown by the length. So each interval adds the most that any place
    there moves outward in it.

    Args:
        moves: the machine on its way.
        faces: of the links that move.
        boxes: where it counts.
        at: travel at the ends of the intervals, none of which has a knot of the course within it, (intervals + 1,).
        rates: the most that any point of each link moves per unit of travel, (links,).
        most: the length [m].

    Returns:
        The interval's index, the row of the box in which it moves outward the most then, and the face's link; -1 for
        each if there is none.
    """
    links = moves.tree.parent.size
    places = np.empty((3, 1, links, 4, 4))
    room, triangle, moved = np.empty((2, CORNERS, 4)), np.empty((3, 3)), np.empty(3)
    low, high = _about(boxes)
    first = 0
    place_at(moves, at[0], places[first])
    total = 0.0
    for n in range(at.size - 1):
        half, last = (at[n + 1] - at[n]) / 2, 2 - first
        place_at(moves, at[n] + half, places[1])
        place_at(moves, at[n + 1], places[last])
        worst, box, link = 0.0, -1, -1
        for group in range(faces.link.size):
            row = faces.link[group]
            grown = rates[row] * half + most + ROUNDING_M
            if not _is_near(faces, group, places[1, 0, row], low[row], high[row], grown):
                continue
            there = places[first, 0, row], places[1, 0, row], places[last, 0, row]
            for m in range(faces.start[group], faces.stop[group]):
                length = _move(faces, m, there, (triangle, moved))
                if min(max(moved[0], moved[1], moved[2]) * faces.sharp[m], length) <= worst:
                    continue
                for b in range(boxes.parts.size):
                    if boxes.links[b, row] and _meets(triangle, boxes.corner[b], boxes.edge, grown):
                        inside = _most_in(triangle, moved, boxes, b, grown, room)
                        found = min(inside * faces.sharp[m], length)
                        if found > worst:
                            worst, box, link = found, b, row
        total += worst
        if total > most:
            return n, box, link
        first = last
    return -1, -1, -1


@njit
def _about(boxes):
    """By link, the box about all boxes in which it is asked about: least and greatest corners, (links, 3) [m]."""
    links = boxes.links.shape[1]
    low, high = np.full((links, 3), np.inf), np.full((links, 3), -np.inf)
    for b in range(boxes.parts.size):
        for row in range(links):
            if boxes.links[b, row]:
                for axis in range(3):
                    low[row, axis] = min(low[row, axis], boxes.corner[b, axis])
                    high[row, axis] = max(high[row, axis], boxes.corner[b, axis] + boxes.edge)
    return low, high


@uncounted()
def _is_near(faces, group, world_from_link, low, high, grown):
    """Whether a group's ball comes within a box, grown."""
    x, y, z = carried(world_from_link, faces.centre[group])
    r = faces.radius[group] + grown
    dx, dy, dz = gap(x, low[0], high[0]), gap(y, low[1], high[1]), gap(z, low[2], high[2])
    return dx * dx + dy * dy + dz * dz <= r * r


@uncounted()
def _move(faces, m, there, rooms):
    """How a triangle moves in an interval: the most that a corner of it does.

    Its link is there at the start of it, amid it and at its end. Fills the triangle amid it, (3, 3), and how far each
    corner moves outward, (3,) [m].
    """
    triangle, moved = rooms
    before, middle, after = there
    for corner in range(3):
        x, y, z = carried(middle, faces.triangles[m, corner])
        triangle[corner, 0], triangle[corner, 1], triangle[corner, 2] = x, y, z
    a, b, c = normal_of(triangle)
    size = np.sqrt(a * a + b * b + c * c)
    most = 0.0
    for corner in range(3):
        x, y, z = carried(before, faces.triangles[m, corner])
        p, q, r = carried(after, faces.triangles[m, corner])
        x, y, z = p - x, q - y, r - z
        length = np.sqrt(x * x + y * y + z * z)
        moved[corner] = (x * a + y * b + z * c) / size if size > 0.0 else length
        most = max(most, length)
    if not faces.sided[m]:
        moved[0], moved[1], moved[2] = most, most, most
    return most


@uncounted()
def _most_in(triangle, moved, boxes, b, grown, room):
    """The most that a triangle that meets a box moves outward in those parts of it, grown, that count.

    Args:
        triangle, moved: of `_move`.
        boxes, b: the box, a row of them.
        grown: by how much [m].
        room: (2, CORNERS, 4) to work in.
    """
    corner, edge, parts = boxes.corner[b], boxes.edge, boxes.parts[b]
    x, y, z = corner[0], corner[1], corner[2]
    if ~parts == 0:
        return _most_of_cut(triangle, moved, (x - grown, y - grown, z - grown), edge + 2 * grown, room)
    most, part = 0.0, edge / PARTS
    for bit in range(64):
        if parts & (np.uint64(1) << np.uint64(bit)):
            i, j, k = bit >> 4, (bit >> 2) & 3, bit & 3
            at = x + i * part, y + j * part, z + k * part
            if _meets(triangle, at, part, grown):
                low = at[0] - grown, at[1] - grown, at[2] - grown
                most = max(most, _most_of_cut(triangle, moved, low, part + 2 * grown, room))
    return most


@njit(inline="always")
def _meets(triangle, corner, edge, grown):
    """Whether a triangle meets a cube with this least corner, grown."""
    half = edge / 2
    return triangle_meets_box(triangle, corner[0] + half, corner[1] + half, corner[2] + half, half + grown)


@uncounted()
def _most_of_cut(triangle, moved, low, edge, room):
    """The greatest value in that part of a triangle that lies in a cube, of values given at its corners (Sutherland,
    Hodgman, Reentrant Polygon Clipping, 1974); 0 if none is above.

    Args:
        triangle, moved: its corners (3, 3), and the values there (3,).
        low, edge: least corner of the cube, and its edge [m].
        room: (2, CORNERS, 4) to work in.
    """
    count, now = 3, 0
    for n in range(3):
        for axis in range(3):
            room[0, n, axis] = triangle[n, axis]
        room[0, n, 3] = moved[n]
    for axis in range(3):
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            limit = low[axis] + side * edge
            found = 0
            for n in range(count):
                one, other = room[now, n], room[now, (n + 1) % count]
                here, there = sign * (one[axis] - limit), sign * (other[axis] - limit)
                if here >= 0.0:
                    for c in range(4):
                        room[1 - now, found, c] = one[c]
                    found += 1
                if (here >= 0.0) != (there >= 0.0):
                    share = here / (here - there)
                    for c in range(4):
                        room[1 - now, found, c] = one[c] + share * (other[c] - one[c])
                    found += 1
            count, now = found, 1 - now
            if count == 0:
                return 0.0
    most = 0.0
    for n in range(count):
        most = max(most, room[now, n, 3])
    return most
