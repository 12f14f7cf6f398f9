"""Samples of triangles, and what they enclose: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

OPEN, SURFACE, OUTSIDE = 0, 1, 2
"""What a cell of a lattice is: nothing that is known of it, one that the surface touches, one reached from outside."""


class Laid(NamedTuple):
    """A triangle laid on its longest edge.

    Fields:
        first: number of the corner where that edge begins.
        along, up: unit vectors along the edge and from it to the third corner, in the triangle's plane.
        foot: where the third corner stands over the edge, counted from its beginning [m].
        length, height: of the edge, and of the third corner over it [m].
    """

    first: int
    along: tuple[float, float, float]
    up: tuple[float, float, float]
    foot: float
    length: float
    height: float


@njit(cache=True, nogil=True)
def tile_triangles(triangles, pitch, points, reach, fill):
    """Cuts triangles into pieces of about pitch x pitch; returns their number.

    A triangle is cut into columns across its longest edge, each column into cells. A piece is stood for by a
    point of the triangle; all of it lies within `reach` of that point (farthest corner of the cell).

    Args:
        triangles: (m, 3, 3) [m].
        pitch: greatest side of a piece [m].
        points, reach: (n, 3) and (n,) to fill, if `fill`.
    """
    n = 0
    for t in range(triangles.shape[0]):
        laid = _laid(triangles[t])
        a, u, v = triangles[t, laid.first], laid.along, laid.up
        columns = max(1, math.ceil(laid.length / pitch))
        width = laid.length / columns
        for i in range(columns):
            x = (i + 0.5) * width
            top = _top(x, laid)
            highest = _top(min(max(laid.foot, i * width), (i + 1) * width), laid)
            cells = max(1, math.ceil(highest / pitch))
            step = highest / cells
            for j in range(cells):
                if fill:
                    y = min((j + 0.5) * step, top)
                    points[n, 0] = a[0] + x * u[0] + y * v[0]
                    points[n, 1] = a[1] + x * u[1] + y * v[1]
                    points[n, 2] = a[2] + x * u[2] + y * v[2]
                    reach[n] = math.hypot(0.5 * width, max(y - j * step, (j + 1) * step - y))
                n += 1
    return n


@njit(nogil=True)
def _laid(triangle):
    """A triangle, (3, 3), as laid on its longest edge."""
    length, first = -1.0, 0
    for e in range(3):
        a, b = triangle[e], triangle[(e + 1) % 3]
        side = math.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)
        if side > length:
            length, first = side, e
    a, b, c = triangle[first], triangle[(first + 1) % 3], triangle[(first + 2) % 3]
    ux, uy, uz = 0.0, 0.0, 0.0
    if length > 0.0:
        ux, uy, uz = (b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length
    foot = (c[0] - a[0]) * ux + (c[1] - a[1]) * uy + (c[2] - a[2]) * uz
    foot = min(max(foot, 0.0), length)
    vx, vy, vz = c[0] - a[0] - foot * ux, c[1] - a[1] - foot * uy, c[2] - a[2] - foot * uz
    height = math.sqrt(vx * vx + vy * vy + vz * vz)
    if height > 0.0:
        vx, vy, vz = vx / height, vy / height, vz / height
    return Laid(first, (ux, uy, uz), (vx, vy, vz), foot, length, height)


@njit(inline="always")
def _top(x, laid):
    """Height of a triangle over its base at x."""
    if x < laid.foot:
        return laid.height * x / laid.foot
    if laid.foot < laid.length:
        return laid.height * (laid.length - x) / (laid.length - laid.foot)
    return laid.height


@njit(cache=True, nogil=True)
def neighbour_runs(cells, stride_x, stride_y, first):
    """For each cell the nine runs of pieces in the 27 cells about it, shape (cells, 9, 2).

    Args:
        cells: numbers of the cells that hold a piece, rising, in rows along z.
        stride_x, stride_y: by how much the number grows from a cell to the next along x and y (one along z).
        first: (cells + 1,) index of each cell's first piece.
    """
    count = cells.size
    runs = np.empty((count, 9, 2), dtype=np.int32)
    for row in range(9):
        offset = (row // 3 - 1) * stride_x + (row % 3 - 1) * stride_y
        low = high = 0
        for c in range(count):
            while low < count and cells[low] < cells[c] + offset - 1:
                low += 1
            while high < count and cells[high] <= cells[c] + offset + 1:
                high += 1
            runs[c, row, 0] = first[low]
            runs[c, row, 1] = first[high]
    return runs


@njit(cache=True, nogil=True)
def thin_out(points, slack_squared, cell, runs):
    """Chooses points such that every piece is covered by a chosen one.

    Goes through the pieces in order; for one that is not covered yet it takes, among the points that would
    cover it, the one that covers most of those that are left.

    Args:
        points: (n, 3), sorted by cell.
        slack_squared: (n,) square of the distance within which a chosen point covers the piece [m^2].
        cell: (n,) index of the cell of each piece.
        runs: from `neighbour_runs`, for cells whose edge is at least the greatest such distance.

    Returns:
        bool (n,): which points are chosen.
    """
    n = points.shape[0]
    chosen = np.zeros(n, dtype=np.bool_)
    covered = np.zeros(n, dtype=np.bool_)
    for p in range(n):
        if covered[p]:
            continue
        best, most = p, 0
        for row in range(9):
            for q in range(runs[cell[p], row, 0], runs[cell[p], row, 1]):
                if _square(points, p, q) <= slack_squared[p]:
                    gain = _newly_covered(points, slack_squared, covered, runs[cell[q]], q)
                    if gain > most:
                        best, most = q, gain
        chosen[best] = True
        for row in range(9):
            for q in range(runs[cell[best], row, 0], runs[cell[best], row, 1]):
                if _square(points, best, q) <= slack_squared[q]:
                    covered[q] = True
    return chosen


@njit(nogil=True)
def _square(points, p, q):
    """Square of the distance of two points."""
    x, y, z = points[p, 0] - points[q, 0], points[p, 1] - points[q, 1], points[p, 2] - points[q, 2]
    return x * x + y * y + z * z


@njit(nogil=True)
def _newly_covered(points, slack_squared, covered, runs, q):
    """How many pieces in `runs` a point would cover that are not covered yet."""
    count = 0
    for row in range(9):
        for r in range(runs[row, 0], runs[row, 1]):
            if not covered[r] and _square(points, q, r) <= slack_squared[r]:
                count += 1
    return count


@njit(cache=True, nogil=True)
def cluster(points, size, order, stops):
    """Sorts points into clusters of at most `size` that lie close together; returns the number of clusters.

    Splits across the longest side of the bounding box, in whole clusters, until they are small enough.

    Args:
        points: (n, 3).
        size: greatest number of points in a cluster.
        order: (n,) int64 to fill: which point stands where.
        stops: (n + 1,) int64 to fill: cluster c is order[stops[c] : stops[c + 1]].
    """
    n = points.shape[0]
    for p in range(n):
        order[p] = p
    stack = np.empty((128, 2), dtype=np.int64)
    stack[0, 0], stack[0, 1] = 0, n
    depth = 1 if n > 0 else 0
    count = 0
    stops[0] = 0
    while depth > 0:
        depth -= 1
        start, stop = stack[depth, 0], stack[depth, 1]
        if stop - start <= size:
            count += 1
            stops[count] = stop
            continue
        _sort_along_longest(points, order[start:stop])
        clusters = (stop - start + size - 1) // size
        middle = start + (clusters // 2) * size
        stack[depth, 0], stack[depth, 1] = middle, stop
        stack[depth + 1, 0], stack[depth + 1, 1] = start, middle
        depth += 2
    return count


@njit(nogil=True)
def _sort_along_longest(points, order):
    """Sorts some points, given by their numbers, along the longest side of their bounding box."""
    part = order.copy()
    axis, extent = 0, -1.0
    for k in range(3):
        low = high = points[part[0], k]
        for p in part:
            low, high = min(low, points[p, k]), max(high, points[p, k])
        if high - low > extent:
            axis, extent = k, high - low
    along = np.empty(part.size, dtype=points.dtype)
    for p in range(part.size):
        along[p] = points[part[p], axis]
    rank = np.argsort(along)
    for p in range(part.size):
        order[p] = part[rank[p]]


@njit(cache=True, nogil=True)
def mark_surface(triangles, lower, edge, surface):
    """Marks the closed cells of a lattice that triangles touch.

    Args:
        triangles: (m, 3, 3) [m], all within the lattice.
        lower: (3,) least corner of the lattice [m].
        edge: of a cell [m].
        surface: (nx, ny, nz) to fill, bool or uint8.
    """
    corners = np.empty((3, 3))
    normal = np.empty(3)
    first = np.empty(3, dtype=np.int64)
    last = np.empty(3, dtype=np.int64)
    for t in range(triangles.shape[0]):
        for k in range(3):
            for e in range(3):
                corners[e, k] = (triangles[t, e, k] - lower[k]) / edge
            low = min(corners[0, k], corners[1, k], corners[2, k])
            high = max(corners[0, k], corners[1, k], corners[2, k])
            first[k] = max(0, math.floor(low - 1e-9))
            last[k] = min(surface.shape[k] - 1, math.floor(high + 1e-9))
        for k in range(3):
            one, two = (k + 1) % 3, (k + 2) % 3
            normal[k] = (corners[1, one] - corners[0, one]) * (corners[2, two] - corners[0, two])
            normal[k] -= (corners[1, two] - corners[0, two]) * (corners[2, one] - corners[0, one])
        _mark_between(corners, normal, first, last, surface)


@njit(nogil=True)
def _mark_between(corners, normal, first, last, surface):
    """Marks the cells between first and last, (3,) each, that a triangle in units of cells touches.

    Column by column along the axis that the triangle's plane crosses most steeply: there few cells are near it.
    """
    main = 0
    for k in range(1, 3):
        if abs(normal[k]) > abs(normal[main]):
            main = k
    one, two = (main + 1) % 3, (main + 2) % 3
    flat = abs(normal[main]) < 1e-12
    cell = np.empty(3, dtype=np.int64)
    for i in range(first[one], last[one] + 1):
        for j in range(first[two], last[two] + 1):
            low, high = first[main], last[main]
            if not flat:
                rise = -(
                    normal[one] * (i + 0.5 - corners[0, one]) + normal[two] * (j + 0.5 - corners[0, two])
                )
                middle = corners[0, main] + rise / normal[main]
                spread = 0.5 * (abs(normal[one]) + abs(normal[two])) / abs(normal[main]) + 1e-6
                low = max(low, math.floor(middle - spread))
                high = min(high, math.floor(middle + spread))
            cell[one], cell[two] = i, j
            for k in range(low, high + 1):
                cell[main] = k
                if not surface[cell[0], cell[1], cell[2]] and touches_cell(corners, normal, cell):
                    surface[cell[0], cell[1], cell[2]] = SURFACE


@njit(cache=True, nogil=True)
def touches_cell(corners, normal, cell):
    """Whether a triangle touches the closed unit cell at `cell` (separating axes, a hair generous)."""
    for k in range(3):
        low = min(corners[0, k], corners[1, k], corners[2, k])
        high = max(corners[0, k], corners[1, k], corners[2, k])
        if high < cell[k] - 1e-9 or low > cell[k] + 1 + 1e-9:
            return False
    away = 0.0
    for k in range(3):
        away += normal[k] * (cell[k] + 0.5 - corners[0, k])
    if abs(away) > 0.5 * (abs(normal[0]) + abs(normal[1]) + abs(normal[2])) + 1e-9:
        return False
    for e in range(3):
        for k in range(3):
            one, two = (k + 1) % 3, (k + 2) % 3
            x = corners[(e + 1) % 3, one] - corners[e, one]
            y = corners[(e + 1) % 3, two] - corners[e, two]
            low, high = np.inf, -np.inf
            for p in range(3):
                along = x * (corners[p, two] - cell[two] - 0.5) - y * (corners[p, one] - cell[one] - 0.5)
                low, high = min(low, along), max(high, along)
            if low > 0.5 * (abs(x) + abs(y)) + 1e-9 or high < -0.5 * (abs(x) + abs(y)) - 1e-9:
                return False
    return True


@njit(cache=True, nogil=True)
def flood(cells):
    """Marks the open cells of a lattice, (nx, ny, nz) uint8, that its first one reaches from face to face.

    Run by run along the last axis: from each run those beside it are looked at, and where one begins is kept for later.
    """
    later, waiting = np.zeros((1024, 3), dtype=np.int32), 1
    while waiting > 0:
        waiting -= 1
        i, j, k = later[waiting, 0], later[waiting, 1], later[waiting, 2]
        if cells[i, j, k] != OPEN:
            continue
        start, stop = k, k + 1
        while start > 0 and cells[i, j, start - 1] == OPEN:
            start -= 1
        while stop < cells.shape[2] and cells[i, j, stop] == OPEN:
            stop += 1
        for n in range(start, stop):
            cells[i, j, n] = OUTSIDE
        # room for all runs beside this one
        if waiting + 2 * (stop - start) + 4 > later.shape[0]:
            more = np.zeros((2 * later.shape[0] + 2 * cells.shape[2], 3), dtype=np.int32)
            more[:waiting] = later[:waiting]
            later = more
        for side in range(4):
            a, b = i + (side == 0) - (side == 1), j + (side == 2) - (side == 3)
            if 0 <= a < cells.shape[0] and 0 <= b < cells.shape[1]:
                waiting = _note_runs(cells[a, b], a, b, (start, stop), later, waiting)


@njit(nogil=True)
def _note_runs(row, a, b, between, later, waiting):
    """Notes where open runs of a row begin between two places; returns how many wait."""
    opened = False
    for n in range(between[0], between[1]):
        if row[n] == OPEN and not opened:
            later[waiting, 0], later[waiting, 1], later[waiting, 2] = a, b, n
            waiting += 1
        opened = row[n] == OPEN
    return waiting
