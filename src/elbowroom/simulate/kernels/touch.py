"""Which voxels a closed mesh touches: triangle-box test for the surface, winding number for the inside."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.geometry.kernels.triangle import normal_of


class Boxes(NamedTuple):
    """The boxes of an array's voxels: least corner of the first, (3,), edge, and half the edge of each box [m]."""

    lower: np.ndarray
    edge: float
    half: float


class Search(NamedTuple):
    """Voxels that a triangle may meet: first and last along each axis and the one that is looked at, (3,) int64 each;
    the triangle's corners as seen from that one's middle, (3, 3)."""

    first: np.ndarray
    last: np.ndarray
    at: np.ndarray
    corners: np.ndarray


@njit(cache=True, nogil=True)
def touch_surface(triangles, lower, edge, shrink, touched, mark=1):
    """Marks each voxel whose open box a triangle meets, if it is not marked yet.

    Args:
        triangles: shape (m, 3, 3), world frame [m].
        lower: least corner of the array's first voxel, shape (3,) [m].
        edge: edge of a voxel [m].
        shrink: boxes are smaller by this on each side, so that a face on a boundary touches nothing; below zero
            they are larger, by less than a voxel [m].
        touched: bool or whole numbers, shape (nx, ny, nz), 0 where not marked; written.
        mark: what is written.
    """
    boxes = Boxes(lower, edge, 0.5 * edge - shrink)
    first, last, at = np.empty(3, np.int64), np.empty(3, np.int64), np.empty(3, np.int64)
    search = Search(first, last, at, np.empty((3, 3)))
    for t in range(triangles.shape[0]):
        if _range_of(triangles[t], boxes, touched.shape, first, last):
            _touch_between(triangles[t], boxes, search, touched, mark)


@uncounted()
def _range_of(triangle, boxes, size, first, last):
    """Writes the first and last voxel along each axis that a triangle may meet; whether there is one."""
    for axis in range(3):
        a = (triangle[0, axis] - boxes.lower[axis]) / boxes.edge
        b = (triangle[1, axis] - boxes.lower[axis]) / boxes.edge
        c = (triangle[2, axis] - boxes.lower[axis]) / boxes.edge
        low, high = math.floor(min(a, b, c)) - 1.0, math.floor(max(a, b, c)) + 1.0
        if not (low < size[axis] and high >= 0.0):
            return False
        first[axis] = int(max(low, 0.0))
        last[axis] = int(min(high, size[axis] - 1.0))
    return True


@uncounted()
def _touch_between(triangle, boxes, search, touched, mark):
    """Marks the voxels from the first to the last of a search whose open box a triangle meets.

    Column by column along the axis that the plane crosses most steeply: there each meets a short piece of it.
    """
    lower, edge, half = boxes.lower, boxes.edge, boxes.half
    first, last, at = search.first, search.last, search.at
    normal = normal_of(triangle)
    main = 0
    if abs(normal[1]) > abs(normal[main]):
        main = 1
    if abs(normal[2]) > abs(normal[main]):
        main = 2
    second, third = (main + 1) % 3, (main + 2) % 3
    second_slope = third_slope = spread = 0.0
    steep = abs(normal[main]) > 0.0
    if steep:
        second_slope, third_slope = normal[second] / normal[main], normal[third] / normal[main]
        spread = half * (1.0 + abs(second_slope) + abs(third_slope)) + 1e-9
    for p in range(first[second], last[second] + 1):
        centre_p = lower[second] + (p + 0.5) * edge
        for q in range(first[third], last[third] + 1):
            centre_q = lower[third] + (q + 0.5) * edge
            begin, end = first[main], last[main]
            if steep:
                height = (
                    triangle[0, main]
                    - second_slope * (centre_p - triangle[0, second])
                    - third_slope * (centre_q - triangle[0, third])
                )
                low = math.ceil((height - spread - lower[main]) / edge - 0.5)
                high = math.floor((height + spread - lower[main]) / edge - 0.5)
                if not (low <= end and high >= begin):
                    continue
                begin, end = max(begin, int(low)), min(end, int(high))
            at[second], at[third] = p, q
            for r in range(begin, end + 1):
                at[main] = r
                if not touched[at[0], at[1], at[2]] and _meets(triangle, boxes, search):
                    touched[at[0], at[1], at[2]] = mark


@uncounted()
def _meets(triangle, boxes, search):
    """Whether a triangle meets the open box of the voxel that is looked at."""
    for axis in range(3):
        centre = boxes.lower[axis] + (search.at[axis] + 0.5) * boxes.edge
        for corner in range(3):
            search.corners[corner, axis] = triangle[corner, axis] - centre
    return triangle_meets_box(search.corners, boxes.half)


@uncounted()
def triangle_meets_box(corners, half):
    """Separating-axis test of a triangle with the open cube of half edge `half` about the origin.

    Akenine-Moeller, "Fast 3D triangle-box overlap testing", 2001: three faces of the cube, nine cross
    products of edges, the triangle's normal.
    """
    for axis in range(3):
        a, b, c = corners[0, axis], corners[1, axis], corners[2, axis]
        if min(a, b, c) >= half or max(a, b, c) <= -half:
            return False
    for side in range(3):
        following = (side + 1) % 3
        opposite = (side + 2) % 3
        ex = corners[following, 0] - corners[side, 0]
        ey = corners[following, 1] - corners[side, 1]
        ez = corners[following, 2] - corners[side, 2]
        # unit axis x edge, on the edge's own corner and on the opposite one
        on_edge = ey * corners[side, 2] - ez * corners[side, 1]
        off_edge = ey * corners[opposite, 2] - ez * corners[opposite, 1]
        reach = half * (abs(ey) + abs(ez))
        if reach > 0.0 and (min(on_edge, off_edge) >= reach or max(on_edge, off_edge) <= -reach):
            return False
        on_edge = ez * corners[side, 0] - ex * corners[side, 2]
        off_edge = ez * corners[opposite, 0] - ex * corners[opposite, 2]
        reach = half * (abs(ez) + abs(ex))
        if reach > 0.0 and (min(on_edge, off_edge) >= reach or max(on_edge, off_edge) <= -reach):
            return False
        on_edge = ex * corners[side, 1] - ey * corners[side, 0]
        off_edge = ex * corners[opposite, 1] - ey * corners[opposite, 0]
        reach = half * (abs(ex) + abs(ey))
        if reach > 0.0 and (min(on_edge, off_edge) >= reach or max(on_edge, off_edge) <= -reach):
            return False
    ux, uy, uz = corners[1, 0] - corners[0, 0], corners[1, 1] - corners[0, 1], corners[1, 2] - corners[0, 2]
    vx, vy, vz = corners[2, 0] - corners[0, 0], corners[2, 1] - corners[0, 1], corners[2, 2] - corners[0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    distance = nx * corners[0, 0] + ny * corners[0, 1] + nz * corners[0, 2]
    reach = half * (abs(nx) + abs(ny) + abs(nz))
    return reach == 0.0 or abs(distance) < reach


@njit(cache=True, nogil=True)
def fill_inside(triangles, lower, edge, touched):
    """Marks each voxel whose centre lies inside a closed mesh, by its winding number along z.

    A voxel that no triangle touches lies wholly inside or wholly outside, so its centre speaks for all of it.
    Columns of centres are pierced from below; what happens outside the array in x and y does not matter, what
    lies below it is counted, so solids may reach beyond the array. Closed parts may overlap: numbers add up.

    Args:
        triangles: shape (m, 3, 3), counter-clockwise seen from outside, world frame [m].
        lower: least corner of the array's first voxel, shape (3,) [m].
        edge: edge of a voxel [m].
        touched: bool, shape (nx, ny, nz), written.
    """
    nx, ny, nz = touched.shape
    winding = np.zeros((nx, ny, nz), np.int16)
    for t in range(triangles.shape[0]):
        _wind(triangles[t], lower, edge, winding)
    for i in range(nx):
        for j in range(ny):
            total = 0
            for k in range(nz):
                total += winding[i, j, k]
                if total != 0:
                    touched[i, j, k] = True


@uncounted()
def _wind(triangle, lower, edge, winding):
    """Adds to each column of centres that pierces a triangle, at the first centre above, how often and which way."""
    nx, ny, nz = winding.shape
    ax, ay = triangle[0, 0], triangle[0, 1]
    bx, by = triangle[1, 0], triangle[1, 1]
    cx, cy = triangle[2, 0], triangle[2, 1]
    low_i = max(math.ceil((min(ax, bx, cx) - lower[0]) / edge - 0.5) - 1.0, 0.0)
    high_i = min(math.floor((max(ax, bx, cx) - lower[0]) / edge - 0.5) + 1.0, nx - 1.0)
    low_j = max(math.ceil((min(ay, by, cy) - lower[1]) / edge - 0.5) - 1.0, 0.0)
    high_j = min(math.floor((max(ay, by, cy) - lower[1]) / edge - 0.5) + 1.0, ny - 1.0)
    if not (low_i <= high_i and low_j <= high_j):
        return
    for i in range(int(low_i), int(high_i) + 1):
        x = lower[0] + (i + 0.5) * edge
        for j in range(int(low_j), int(high_j) + 1):
            y = lower[1] + (j + 0.5) * edge
            # a ray crosses the triangle if it crosses its outline an odd number of times, seen along z
            turns = (
                _crossing(ax, ay, bx, by, x, y)
                + _crossing(bx, by, cx, cy, x, y)
                + _crossing(cx, cy, ax, ay, x, y)
            )
            if turns == 0:
                continue
            above = math.ceil((_height(triangle, x, y) - lower[2]) / edge - 0.5)
            if above < nz:
                winding[i, j, int(max(above, 0.0))] -= turns


@uncounted()
def _height(triangle, x, y):
    """Height of a triangle at (x, y): those of its corners weighted by the areas opposite to them."""
    ax, ay, az = triangle[0, 0], triangle[0, 1], triangle[0, 2]
    bx, by, bz = triangle[1, 0], triangle[1, 1], triangle[1, 2]
    cx, cy, cz = triangle[2, 0], triangle[2, 1], triangle[2, 2]
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    z = az
    if area != 0.0:
        weight_b = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
        weight_c = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
        z += weight_b * (bz - az) + weight_c * (cz - az)
    return min(max(z, min(az, bz, cz)), max(az, bz, cz))


@njit(cache=True, nogil=True)
def _crossing(px, py, qx, qy, x, y):
    """How an edge passes the half-line from (x, y) towards +x: +1 upwards in y, -1 downwards, 0 not at all.

    Both triangles at an edge get the same answer with opposite sign, as its ends are taken in one order.
    """
    sign = 1
    if py > qy or (py == qy and px > qx):
        px, py, qx, qy = qx, qy, px, py
        sign = -1
    if not (py <= y < qy):
        return 0
    if (qx - px) * (y - py) - (qy - py) * (x - px) > 0.0:
        return sign
    return 0
