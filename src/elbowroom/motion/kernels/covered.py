"""Which blocked voxels a body reaches into where it stands, and which of their cells it covers."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, uncounted, word_of
from elbowroom.motion.kernels.mover import ROUNDING_M, Skin, carried
from elbowroom.motion.kernels.near import TOGETHER, near_members
from elbowroom.motion.kernels.shared import CELLS
from elbowroom.motion.kernels.volume import cell_of, counted, gap, meets_in_box

OPEN, COVERED = 0, 1
"""What is known of a cell: nothing yet, or that the body covers it. From 2 on: it is in a room beside the body."""
RAYS = ((0.5377, 0.8339, -0.1241), (-0.4336, 0.3426, 0.8334), (0.7254, -0.6631, 0.1848))
"""Along all of these a point within a closed surface meets it an odd number of times."""


class Pieces(NamedTuple):
    """The surface of links, cut into pieces that hang together.

    Fields:
        triangles: piece by piece, link frame [m], (m, 3, 3).
        centre, radius: of a ball about each, (m, 3) and (m,) [m].
        start: of each piece, and the end of the last, (pieces + 1,).
        link: of each piece, (pieces,).
        closed: whether it encloses a solid, (pieces,).
        lower, upper: of the box about it, (pieces, 3) [m].
    """

    triangles: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    start: np.ndarray
    link: np.ndarray
    closed: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


class Grown(NamedTuple):
    """A skin that stands still, and by how much its samples are grown, by cluster [m]: as `near_members` takes them."""

    skin: Skin
    speeds: np.ndarray


@njit(cache=True, nogil=True)
def reached(placed, skin, reach, volume, numbers):
    """The blocked voxels within reach of a skin's samples, in any order, some more than once.

    Args:
        placed: where links are, (links, 4, 4).
        skin: samples in clusters.
        reach: about a sample [m].
        volume: what is blocked.
        numbers: written, int64.

    Returns:
        How many were found; if there is not room for all, one more than there is.
    """
    # the filter of samples grows them by what a cluster moves: a little more than reach, and what is found decides
    grown = Grown(skin, np.full(skin.link.size, reach - skin.cover + ROUNDING_M))
    near, at = np.empty(skin.cluster_of.size, dtype=np.int32), np.empty((3, TOGETHER), dtype=np.int32)
    clusters, count = np.empty(1, dtype=np.int32), 0
    for cluster in range(skin.link.size):
        if not _reaches_into(placed[skin.link[cluster]], skin, cluster, reach + ROUNDING_M, volume):
            continue
        clusters[0] = cluster
        many = near_members(placed, grown, 1.0, volume, clusters, near, at)
        count = _list_reached(placed[skin.link[cluster]], skin, near[:many], reach, volume, numbers, count)
        if count > numbers.size:
            break
    return count


@uncounted()
def _reaches_into(world_from_link, skin, cluster, reach, volume):
    """Whether the box along the axes about a cluster's samples, grown, may hold a part of a block."""
    rx, ry, rz = reach, reach, reach
    for axis in range(3):
        rx += abs(world_from_link[0, axis]) * skin.half[cluster, axis]
        ry += abs(world_from_link[1, axis]) * skin.half[cluster, axis]
        rz += abs(world_from_link[2, axis]) * skin.half[cluster, axis]
    middle = carried(world_from_link, skin.centre[cluster])
    return meets_in_box(volume.words, volume.cubes, volume.lattice, middle, (rx, ry, rz))


@uncounted()
def _list_reached(world_from_link, skin, samples, reach, volume, numbers, count):
    """Lists the blocked voxels within reach of some samples after those that are listed; how many there are then."""
    lattice = volume.lattice
    for sample in samples:
        x, y, z = carried(world_from_link, skin.points[sample])
        u, v, w, s = counted(x, y, z, reach + ROUNDING_M, lattice)
        for i in range(cell_of(u - s, lattice.nx), cell_of(u + s, lattice.nx) + 1):
            du = gap(u, i * 1.0, i + 1.0)
            for j in range(cell_of(v - s, lattice.ny), cell_of(v + s, lattice.ny) + 1):
                dv = gap(v, j * 1.0, j + 1.0)
                for k in range(cell_of(w - s, lattice.nz), cell_of(w + s, lattice.nz) + 1):
                    dw = gap(w, k * 1.0, k + 1.0)
                    word = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)
                    if not volume.words[word] & bit_of(i, j, k) or du * du + dv * dv + dw * dw > s * s:
                        continue
                    number = (i * lattice.ny + j) * lattice.nz + k
                    if count and numbers[count - 1] == number:
                        continue
                    if count == numbers.size:
                        return count + 1
                    numbers[count] = number
                    count += 1
    return count


@njit(cache=True, nogil=True)
def open_cells(pieces, placed, voxels, reach, cells, links):
    """Of some voxels, the cells that a body does not cover (`cover`).

    Args:
        pieces, placed, reach: as of `cover`.
        voxels: their least corners, and their edge, (n, 4) [m].
        cells: (n, 64) uint64, written: a word for each part of 4 x 4 x 4 cells, as of `kernels.shared.Shared`.
        links: (n, links) bool: set for links that are near.
    """
    covered = np.empty((CELLS, CELLS, CELLS), dtype=np.uint8)
    for n in range(len(voxels)):
        cover(pieces, placed, voxels[n], reach, covered, links[n])
        cells[n] = 0
        for i in range(CELLS):
            for j in range(CELLS):
                for k in range(CELLS):
                    if covered[i, j, k] != COVERED:
                        part = ((i >> 2) * 4 + (j >> 2)) * 4 + (k >> 2)
                        cells[n, part] |= bit_of(i, j, k)


@njit(cache=True, nogil=True)
def cover(pieces, placed, voxel, reach, covered, links):
    """Which cells of a voxel a body covers: those that come within reach of its surface, or lie within it.

    Cells that are not near the surface hang together in rooms; a room lies within the body if any of its cells does,
    and that is asked of one.

    Args:
        pieces: of the body.
        placed: where links are, (links, 4, 4).
        voxel: its least corner and its edge, (4,) [m].
        reach: of a cell's middle from the surface [m]: the cell is covered; and its link is near the voxel.
        covered: (16, 16, 16) uint8, written: `COVERED`, or another number.
        links: (links,) bool: set for links that are near.
    """
    corner, edge = voxel[:3], voxel[3]
    covered[:] = OPEN
    triangle = np.empty((3, 3))
    middle = np.array([corner[0] + edge / 2, corner[1] + edge / 2, corner[2] + edge / 2])
    around = np.sqrt(0.75) * edge + reach[1]
    for piece in range(pieces.link.size):
        world_from_link = placed[pieces.link[piece]]
        if not _is_near(pieces, piece, world_from_link, middle, around):
            continue
        for n in range(pieces.start[piece], pieces.start[piece + 1]):
            x, y, z = carried(world_from_link, pieces.centre[n])
            away = around + pieces.radius[n]
            dx, dy, dz = x - middle[0], y - middle[1], z - middle[2]
            if dx * dx + dy * dy + dz * dz > away * away:
                continue
            for c in range(3):
                triangle[c, 0], triangle[c, 1], triangle[c, 2] = carried(
                    world_from_link, pieces.triangles[n, c]
                )
            if _cover_near(triangle, corner, edge / CELLS, reach, covered):
                links[pieces.link[piece]] = True
    room = COVERED
    stack = np.empty((CELLS * CELLS * CELLS, 3), dtype=np.int8)
    for i in range(CELLS):
        for j in range(CELLS):
            for k in range(CELLS):
                if covered[i, j, k] != OPEN:
                    continue
                room = min(room + 1, 255)
                x, y, z = (
                    corner[0] + (i + 0.5) * edge / CELLS,
                    corner[1] + (j + 0.5) * edge / CELLS,
                    corner[2] + (k + 0.5) * edge / CELLS,
                )
                inside = _is_within(pieces, placed, x, y, z)
                _fill_room(covered, i, j, k, COVERED if inside else room, stack)


@njit
def _is_near(pieces, piece, world_from_link, middle, around):
    """Whether the box about a piece comes within a ball."""
    x, y, z = _in_link(world_from_link, middle[0], middle[1], middle[2])
    low, high = pieces.lower[piece], pieces.upper[piece]
    dx, dy, dz = gap(x, low[0], high[0]), gap(y, low[1], high[1]), gap(z, low[2], high[2])
    return dx * dx + dy * dy + dz * dz <= around * around


@njit(inline="always")
def _in_link(world_from_link, x, y, z):
    """A point of the world in a link's frame."""
    m = world_from_link
    dx, dy, dz = x - m[0, 3], y - m[1, 3], z - m[2, 3]
    return (
        m[0, 0] * dx + m[1, 0] * dy + m[2, 0] * dz,
        m[0, 1] * dx + m[1, 1] * dy + m[2, 1] * dz,
        m[0, 2] * dx + m[1, 2] * dy + m[2, 2] * dz,
    )


@njit
def _cover_near(triangle, corner, cell, reach, covered):
    """Marks the cells whose middle comes within the first reach of a triangle; whether any does within the second."""
    found = False
    first, last = np.empty(3, dtype=np.int64), np.empty(3, dtype=np.int64)
    for axis in range(3):
        low = min(triangle[0, axis], triangle[1, axis], triangle[2, axis]) - reach[1] - corner[axis]
        high = max(triangle[0, axis], triangle[1, axis], triangle[2, axis]) + reach[1] - corner[axis]
        first[axis] = int(min(max(np.floor(low / cell - 0.5), 0.0), float(CELLS)))
        last[axis] = int(max(min(np.ceil(high / cell - 0.5), CELLS - 1.0), -1.0))
    covers, near = reach[0] * reach[0], reach[1] * reach[1]
    for i in range(first[0], last[0] + 1):
        x = corner[0] + (i + 0.5) * cell
        for j in range(first[1], last[1] + 1):
            y = corner[1] + (j + 0.5) * cell
            for k in range(first[2], last[2] + 1):
                if found and covered[i, j, k] != OPEN:
                    continue
                squared = squared_distance(triangle, x, y, corner[2] + (k + 0.5) * cell)
                found |= squared <= near
                if squared <= covers:
                    covered[i, j, k] = COVERED
    return found


@njit
def squared_distance(triangle, x, y, z):
    """Of a point from a triangle, (3, 3), squared (Ericson, Real-Time Collision Detection, 5.1.5)."""
    a, b, c = triangle[0], triangle[1], triangle[2]
    ab = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    ac = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    ap = x - a[0], y - a[1], z - a[2]
    d1, d2 = _dot(ab, ap), _dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return _dot(ap, ap)
    bp = x - b[0], y - b[1], z - b[2]
    d3, d4 = _dot(ab, bp), _dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return _dot(bp, bp)
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return _beyond(ap, ab, d1 / (d1 - d3) if d1 > d3 else 0.0)
    cp = x - c[0], y - c[1], z - c[2]
    d5, d6 = _dot(ab, cp), _dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return _dot(cp, cp)
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return _beyond(ap, ac, d2 / (d2 - d6) if d2 > d6 else 0.0)
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        bc = c[0] - b[0], c[1] - b[1], c[2] - b[2]
        total = (d4 - d3) + (d5 - d6)
        return _beyond(bp, bc, (d4 - d3) / total if total > 0.0 else 0.0)
    total = 1.0 / (va + vb + vc)
    v, w = vb * total, vc * total
    rest = ap[0] - v * ab[0] - w * ac[0], ap[1] - v * ab[1] - w * ac[1], ap[2] - v * ab[2] - w * ac[2]
    return _dot(rest, rest)


@njit(inline="always")
def _dot(a, b):
    """Of three numbers each."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(inline="always")
def _beyond(point, edge, share):
    """Squared length of what is left of a vector less a share of another one."""
    x, y, z = point[0] - share * edge[0], point[1] - share * edge[1], point[2] - share * edge[2]
    return x * x + y * y + z * z


@njit
def _is_within(pieces, placed, x, y, z):
    """Whether a point lies in the solid that any closed piece encloses."""
    for piece in range(pieces.link.size):
        if not pieces.closed[piece]:
            continue
        a, b, c = _in_link(placed[pieces.link[piece]], x, y, z)
        low, high = pieces.lower[piece], pieces.upper[piece]
        if a < low[0] or a > high[0] or b < low[1] or b > high[1] or c < low[2] or c > high[2]:
            continue
        inside = True
        for ray in RAYS:
            odd = False
            for n in range(pieces.start[piece], pieces.start[piece + 1]):
                odd ^= _is_met(pieces.triangles[n], a, b, c, ray)
            inside &= odd
            if not inside:
                break
        if inside:
            return True
    return False


@njit(inline="always")
def _is_met(triangle, x, y, z, ray):
    """Whether a ray from a point meets a triangle (Möller, Trumbore, Fast, Minimum Storage Ray-Triangle
    Intersection, 1997)."""
    a, b, c = triangle[0], triangle[1], triangle[2]
    e = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    f = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    p = ray[1] * f[2] - ray[2] * f[1], ray[2] * f[0] - ray[0] * f[2], ray[0] * f[1] - ray[1] * f[0]
    determinant = _dot(e, p)
    if determinant == 0.0:
        return False
    t = x - a[0], y - a[1], z - a[2]
    u = _dot(t, p) / determinant
    if u < 0.0 or u > 1.0:
        return False
    q = t[1] * e[2] - t[2] * e[1], t[2] * e[0] - t[0] * e[2], t[0] * e[1] - t[1] * e[0]
    v = _dot(ray, q) / determinant
    return v >= 0.0 and u + v <= 1.0 and _dot(f, q) / determinant > 0.0


@njit
def _fill_room(covered, i, j, k, mark, stack):
    """Marks all open cells that hang together with one, face by face."""
    covered[i, j, k] = mark
    stack[0, 0], stack[0, 1], stack[0, 2] = i, j, k
    left = 1
    while left:
        left -= 1
        i, j, k = int(stack[left, 0]), int(stack[left, 1]), int(stack[left, 2])
        for axis in range(3):
            for step in (-1, 1):
                a = i + step if axis == 0 else i
                b = j + step if axis == 1 else j
                c = k + step if axis == 2 else k
                if not (0 <= a < CELLS and 0 <= b < CELLS and 0 <= c < CELLS) or covered[a, b, c] != OPEN:
                    continue
                covered[a, b, c] = mark
                stack[left, 0], stack[left, 1], stack[left, 2] = a, b, c
                left += 1
