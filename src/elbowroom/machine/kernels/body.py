"""Where links are, and which voxels a body covers: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, uncounted, word_of
from elbowroom.geometry.kernels.rigid import moved, turned

FIXED, SLIDES, TURNS = 0, 1, 2
"""Kinds of joints."""
MAX_BLOCKS = 4096
"""A cluster that may come near more corners of the grid, or lie in more voxels, marks its balls one by one."""
MOST_ALONG = 62
"""So many voxels that a cluster may lie in stand in one word along an axis, with one more on either side."""
TOGETHER = 64
"""Samples that are looked at before what they meet is noted."""


class Tree(NamedTuple):
    """A kinematic tree, a row for each link, parents first; `column`: its joint position, -1 for none."""

    parent: np.ndarray
    parent_from_joint: np.ndarray
    axis: np.ndarray
    kind: np.ndarray
    column: np.ndarray
    multiplier: np.ndarray
    offset: np.ndarray


class Clusters(NamedTuple):
    """Surface samples that lie close together on one link, (n, 3) in its frame [m]: cluster c is
    points[start[c] : stop[c]], on link[c], within a ball of radius[c] about centre[c]."""

    points: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    link: np.ndarray
    centre: np.ndarray
    radius: np.ndarray


class Noted(NamedTuple):
    """Room to note what the samples of one cluster meet, by place in the box about them.

    Fields:
        blocks: uint8, by the corner nearest to samples, which of the eight voxels about it; zeros between clusters.
        about: uint32, by the voxel that samples lie in, which of the 27 about it; zeros between clusters.
        rows: uint64, voxels along the third axis; zeros between clusters.
        met: of some samples, number of the voxel that each lies in and which of the 27 about it, (2, `TOGETHER`) int32.
        placed: of some samples, where they are in voxels from the grid's corner, (3, `TOGETHER`).
    """

    blocks: np.ndarray
    about: np.ndarray
    rows: np.ndarray
    met: np.ndarray
    placed: np.ndarray


@njit(cache=True, nogil=True)
def place_links(tree, world_from_base, positions, world_from_link):
    """Forward kinematics: fills world_from_link (n, links, 4, 4) for positions (n, joints)."""
    parent_from_link = np.empty((3, 4))
    for n in range(positions.shape[0]):
        for row in range(tree.parent.size):
            parent = tree.parent[row]
            if parent < 0:
                for i in range(4):
                    for j in range(4):
                        world_from_link[n, row, i, j] = world_from_base[i, j]
                continue
            parent_from_joint = tree.parent_from_joint[row]
            if tree.kind[row] == FIXED:
                for i in range(3):
                    for j in range(4):
                        parent_from_link[i, j] = parent_from_joint[i, j]
            else:
                position = positions[n, tree.column[row]] * tree.multiplier[row] + tree.offset[row]
                slides = tree.kind[row] == SLIDES
                _move(parent_from_joint, tree.axis[row], position, slides, parent_from_link)
            _chain(world_from_link[n, parent], parent_from_link, world_from_link[n, row])


@njit(nogil=True)
def _move(parent_from_joint, axis, position, slides, parent_from_link):
    """A joint's frame slid along or turned about the axis; Rodrigues' formula for the turn."""
    x, y, z = axis[0], axis[1], axis[2]
    if slides:
        way = turned(parent_from_joint, x, y, z)
        for i in range(3):
            for j in range(3):
                parent_from_link[i, j] = parent_from_joint[i, j]
            parent_from_link[i, 3] = parent_from_joint[i, 3] + position * way[i]
    else:
        c, s = math.cos(position), math.sin(position)
        d = 1.0 - c
        for i in range(3):
            a, b, e = parent_from_joint[i, 0], parent_from_joint[i, 1], parent_from_joint[i, 2]
            parent_from_link[i, 0] = a * (c + x * x * d) + b * (x * y * d + z * s) + e * (x * z * d - y * s)
            parent_from_link[i, 1] = a * (x * y * d - z * s) + b * (c + y * y * d) + e * (y * z * d + x * s)
            parent_from_link[i, 2] = a * (x * z * d + y * s) + b * (y * z * d - x * s) + e * (c + z * z * d)
            parent_from_link[i, 3] = parent_from_joint[i, 3]


@njit(nogil=True)
def _chain(world_from_parent, parent_from_link, world_from_link):
    """The product of two transforms, the second of three rows; written into the third."""
    for i in range(3):
        for j in range(4):
            world_from_link[i, j] = (
                world_from_parent[i, 0] * parent_from_link[0, j]
                + world_from_parent[i, 1] * parent_from_link[1, j]
                + world_from_parent[i, 2] * parent_from_link[2, j]
            )
        world_from_link[i, 3] += world_from_parent[i, 3]
        world_from_link[3, i] = 0.0
    world_from_link[3, 3] = 1.0


@njit(cache=True, nogil=True)
def mark_balls(clusters, share, shares, world_from_links, reach, lattice, words):
    """Sets the voxels that balls about surface samples meet: those whose box lies within `reach` of a sample.

    Args:
        clusters: of the samples.
        share, shares: does every shares-th cluster from share on.
        world_from_links: (links, 4, 4).
        reach: radius of the balls [m].
        lattice: the voxel grid.
        words: the plane to set bits in.
    """
    r = reach * (1.0 / lattice.edge)
    noted = Noted(
        np.zeros(MAX_BLOCKS, dtype=np.uint8),
        np.zeros(MAX_BLOCKS, dtype=np.uint32),
        np.zeros(MAX_BLOCKS, dtype=np.uint64),
        np.empty((2, TOGETHER), dtype=np.int32),
        np.empty((3, TOGETHER)),
    )
    voxels_from_link = np.empty((3, 4))
    for c in range(share, clusters.start.size, shares):
        _scale(world_from_links[clusters.link[c]], lattice, voxels_from_link)
        if 0.5 < r <= 1.0:
            _mark_large(clusters, c, voxels_from_link, r, lattice, noted, words)
        else:
            _mark_cluster(clusters, c, voxels_from_link, r, lattice, noted.blocks, words)


@uncounted(error_model="numpy")
def _mark_large(clusters, c, voxels_from_link, r, lattice, noted, words):
    """As `_mark_cluster`, for balls of a radius r from half a voxel to one.

    Such a ball meets only the 3 x 3 x 3 voxels about the one that its middle lies in. The cluster notes 27 bits for
    each such voxel first, then rows of voxels along the third axis as bits of words, and sets the voxels at its end.
    """
    x, y, z = moved(voxels_from_link, clusters.centre[c, 0], clusters.centre[c, 1], clusters.centre[c, 2])
    around = clusters.radius[c] * (1.0 / lattice.edge) + 1e-6
    if not _comes_near(x, y, z, around + r, lattice):
        return
    i0, j0, k0 = math.floor(x - around), math.floor(y - around), math.floor(z - around)
    ni, nj, nk = (
        math.floor(x + around) - i0 + 1,
        math.floor(y + around) - j0 + 1,
        math.floor(z + around) - k0 + 1,
    )
    start, stop = clusters.start[c], clusters.stop[c]
    if ni * nj * nk > MAX_BLOCKS or (ni + 2) * (nj + 2) > MAX_BLOCKS or nk > MOST_ALONG:
        for p in range(start, stop):
            x, y, z = moved(
                voxels_from_link, clusters.points[p, 0], clusters.points[p, 1], clusters.points[p, 2]
            )
            _mark_ball(x, y, z, r, lattice, words)
        return
    corner, counts = (i0, j0, k0), (ni, nj, nk)
    for first in range(start, stop, TOGETHER):
        last = min(first + TOGETHER, stop)
        _place_points(clusters.points, first, last, voxels_from_link, noted.placed)
        _look_about(noted.placed, last - first, corner, counts, r * r, noted.met)
        for n in range(last - first):
            noted.about[noted.met[0, n]] |= np.uint32(noted.met[1, n])
    _gather_rows(noted.about, counts, noted.rows)
    for row in range((ni + 2) * (nj + 2)):
        if noted.rows[row] != 0:
            _set_row(
                i0 - 1 + row // (nj + 2), j0 - 1 + row % (nj + 2), k0 - 1, noted.rows[row], lattice, words
            )
            noted.rows[row] = 0


@njit(inline="always")
def _comes_near(x, y, z, reach, lattice):
    """Whether a place, in voxels from the grid's corner, is within reach of the grid."""
    return (
        -reach <= x <= lattice.nx + reach
        and -reach <= y <= lattice.ny + reach
        and -reach <= z <= lattice.nz + reach
    )


@uncounted()
def _place_points(points, first, last, voxels_from_link, placed):
    """Some points of a link in voxels from the grid's corner, (3, last - first)."""
    for axis in range(3):
        a, b = voxels_from_link[axis, 0], voxels_from_link[axis, 1]
        c, d = voxels_from_link[axis, 2], voxels_from_link[axis, 3]
        for n in range(last - first):
            u, p = np.uint64(n), np.uint64(first + n)
            placed[axis, u] = a * points[p, 0] + b * points[p, 1] + c * points[p, 2] + d


@uncounted(error_model="numpy")
def _look_about(placed, count, corner, counts, square, met):
    """Of each place the voxel that it lies in, counted in a box, and which of the 27 about that its ball meets.

    Bit 9 a + 3 b + c stands for the voxel (a - 1, b - 1, c - 1) from there. Distances are worked out as `_mark_ball`
    does it, bit by bit.

    Args:
        placed: (3, count) places in voxels from the grid's corner.
        count: how many.
        corner, counts: least voxel of the box, and how many it has along each axis.
        square: of the ball's radius.
        met: (2, count) int32, written: number in the box, and the bits.
    """
    i0, j0, k0, nj, nk = corner[0], corner[1], corner[2], counts[1], counts[2]
    for n in range(count):
        u = np.uint64(n)
        x, y, z = placed[0, u], placed[1, u], placed[2, u]
        i, j, k = math.floor(x), math.floor(y), math.floor(z)
        a0, b0, c0 = x - (i - 1.0) - 1.0, y - (j - 1.0) - 1.0, z - (k - 1.0) - 1.0
        a2, b2, c2 = (i + 1.0) - x, (j + 1.0) - y, (k + 1.0) - z
        a0, b0, c0, a2, b2, c2 = a0 * a0, b0 * b0, c0 * c0, a2 * a2, b2 * b2, c2 * c2
        bits = np.int32(1 << 13)
        bits |= np.int32(a0 <= square) << 4 | np.int32(a2 <= square) << 22
        bits |= np.int32(b0 <= square) << 10 | np.int32(b2 <= square) << 16
        bits |= np.int32(c0 <= square) << 12 | np.int32(c2 <= square) << 14
        bits |= np.int32(a0 + b0 <= square) << 1 | np.int32(a0 + b2 <= square) << 7
        bits |= np.int32(a2 + b0 <= square) << 19 | np.int32(a2 + b2 <= square) << 25
        bits |= np.int32(a0 + c0 <= square) << 3 | np.int32(a0 + c2 <= square) << 5
        bits |= np.int32(a2 + c0 <= square) << 21 | np.int32(a2 + c2 <= square) << 23
        bits |= np.int32(b0 + c0 <= square) << 9 | np.int32(b0 + c2 <= square) << 11
        bits |= np.int32(b2 + c0 <= square) << 15 | np.int32(b2 + c2 <= square) << 17
        bits |= np.int32(a0 + b0 + c0 <= square) | np.int32(a0 + b0 + c2 <= square) << 2
        bits |= np.int32(a0 + b2 + c0 <= square) << 6 | np.int32(a0 + b2 + c2 <= square) << 8
        bits |= np.int32(a2 + b0 + c0 <= square) << 18 | np.int32(a2 + b0 + c2 <= square) << 20
        bits |= np.int32(a2 + b2 + c0 <= square) << 24 | np.int32(a2 + b2 + c2 <= square) << 26
        met[0, u] = (np.int32(i - i0) * nj + np.int32(j - j0)) * nk + np.int32(k - k0)
        met[1, u] = bits


@uncounted()
def _gather_rows(about, counts, rows):
    """Gathers what was noted about the voxels of a box as rows of bits along its third axis, one voxel more each way.

    Row i (nj + 2) + j holds in bit k the voxel (i - 1, j - 1, k - 1) of the box; `about` is zeros afterwards.
    """
    ni, nj, nk = counts
    for i in range(ni):
        for j in range(nj):
            for k in range(nk):
                bits = about[(i * nj + j) * nk + k]
                if bits == 0:
                    continue
                about[(i * nj + j) * nk + k] = 0
                for side in range(9):
                    three = np.uint64((bits >> np.uint32(3 * side)) & np.uint32(7))
                    rows[(i + side // 3) * (nj + 2) + j + side % 3] |= three << np.uint64(k)


@uncounted()
def _set_row(i, j, k, row, lattice, words):
    """Sets the voxels (i, j, k + n) for each bit n of a row, as far as they are in the grid."""
    if not (0 <= i < lattice.nx and 0 <= j < lattice.ny):
        return
    if k < 0:
        row, k = row >> np.uint64(-k), 0
    if k >= lattice.nz:
        return
    if lattice.nz - k < 64:
        row &= (np.uint64(1) << np.uint64(lattice.nz - k)) - np.uint64(1)
    place = np.uint64(((i & 3) * 4 + (j & 3)) * 4)
    while row != 0:
        start = np.uint64(k & 3)
        four = (row << start) & np.uint64(15)
        if four != 0:
            words[word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)] |= four << place
        row >>= np.uint64(4) - start
        k += 4 - (k & 3)


@uncounted()
def _mark_cluster(clusters, c, voxels_from_link, r, lattice, blocks, words):
    """Sets the voxels that the balls of one cluster meet, of radius r in voxels.

    A ball of half a voxel's radius at most meets only voxels of the 2 x 2 x 2 block about the grid corner nearest to
    its middle. The cluster notes eight bits for each such corner first, and sets the voxels at its end; `blocks`:
    zeros, and zeros again afterwards.
    """
    points, centre = clusters.points, clusters.centre
    x, y, z = moved(voxels_from_link, centre[c, 0], centre[c, 1], centre[c, 2])
    around = clusters.radius[c] * (1.0 / lattice.edge) + 1e-6
    if not (-around - r <= x <= lattice.nx + around + r and -around - r <= y <= lattice.ny + around + r):
        return
    if not -around - r <= z <= lattice.nz + around + r:
        return
    i0, i1 = math.floor(x - around - 0.5), math.floor(x + around - 0.5)
    j0, j1 = math.floor(y - around - 0.5), math.floor(y + around - 0.5)
    k0, k1 = math.floor(z - around - 0.5), math.floor(z + around - 0.5)
    ny, nz = j1 - j0 + 1, k1 - k0 + 1
    count = (i1 - i0 + 1) * ny * nz
    if r > 0.5 or count > MAX_BLOCKS:
        for p in range(clusters.start[c], clusters.stop[c]):
            x, y, z = moved(voxels_from_link, points[p, 0], points[p, 1], points[p, 2])
            _mark_ball(x, y, z, r, lattice, words)
        return
    for p in range(clusters.start[c], clusters.stop[c]):
        x, y, z = moved(voxels_from_link, points[p, 0], points[p, 1], points[p, 2])
        i, j, k = math.floor(x - 0.5), math.floor(y - 0.5), math.floor(z - 0.5)
        place = ((i - i0) * ny + (j - j0)) * nz + (k - k0)
        blocks[place] |= _block_met(x - i - 1.0, y - j - 1.0, z - k - 1.0, r * r)
    for place in range(count):
        if blocks[place] != 0:
            i, j, k = i0 + place // (ny * nz), j0 + place // nz % ny, k0 + place % nz
            _set_block(i, j, k, blocks[place], lattice, words)
            blocks[place] = 0


@njit(nogil=True)
def _block_met(x, y, z, square):
    """Which voxels about a grid corner a ball meets; its middle lies at (x, y, z), +-0.5, from there.

    Bit 4 i + 2 j + k stands for the voxel on side (i, j, k) of the corner, 0 below and 1 above.
    """
    x0, x1 = max(x, 0.0) * x, min(x, 0.0) * x
    y0, y1 = max(y, 0.0) * y, min(y, 0.0) * y
    z0, z1 = max(z, 0.0) * z, min(z, 0.0) * z
    return np.uint8(
        (x0 + y0 + z0 <= square)
        | (x0 + y0 + z1 <= square) << 1
        | (x0 + y1 + z0 <= square) << 2
        | (x0 + y1 + z1 <= square) << 3
        | (x1 + y0 + z0 <= square) << 4
        | (x1 + y0 + z1 <= square) << 5
        | (x1 + y1 + z0 <= square) << 6
        | (x1 + y1 + z1 <= square) << 7
    )


@njit(nogil=True)
def _set_block(i, j, k, block, lattice, words):
    """Sets the voxels from (i, j, k) on whose bits stand in `block`, as far as they are in the grid."""
    for n in range(8):
        if (block >> n) & 1:
            a, b, c = i + (n >> 2), j + ((n >> 1) & 1), k + (n & 1)
            if 0 <= a < lattice.nx and 0 <= b < lattice.ny and 0 <= c < lattice.nz:
                words[word_of(a, b, c, lattice.cubes_y, lattice.cubes_z)] |= bit_of(a, b, c)


@njit(nogil=True)
def _scale(world_from_link, lattice, voxels_from_link):
    """A link's pose in voxels from the grid's corner: three rows."""
    scale = 1.0 / lattice.edge
    for j in range(4):
        for i in range(3):
            voxels_from_link[i, j] = world_from_link[i, j] * scale
    voxels_from_link[0, 3] -= lattice.x0 * scale
    voxels_from_link[1, 3] -= lattice.y0 * scale
    voxels_from_link[2, 3] -= lattice.z0 * scale


@njit(nogil=True)
def _mark_ball(x, y, z, r, lattice, words):
    """Sets the voxels that a ball about (x, y, z) meets, all in voxels from the grid's corner."""
    if not (-r <= x < lattice.nx + r and -r <= y < lattice.ny + r and -r <= z < lattice.nz + r):
        return
    i0, i1 = max(0, math.floor(x - r)), min(lattice.nx - 1, math.floor(x + r))
    j0, j1 = max(0, math.floor(y - r)), min(lattice.ny - 1, math.floor(y + r))
    k0, k1 = max(0, math.floor(z - r)), min(lattice.nz - 1, math.floor(z + r))
    for i in range(i0, i1 + 1):
        dx = max(i - x, x - i - 1.0, 0.0)
        for j in range(j0, j1 + 1):
            dy = max(j - y, y - j - 1.0, 0.0)
            for k in range(k0, k1 + 1):
                dz = max(k - z, z - k - 1.0, 0.0)
                if dx * dx + dy * dy + dz * dz <= r * r:
                    words[word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)] |= bit_of(i, j, k)


@njit(cache=True, nogil=True)
def mark_points(points, links, first, last, world_from_links, lattice, words):
    """Sets the voxels that hold the points first to last; `links`: the row in world_from_links of each."""
    voxels_from_link = np.empty((3, 4))
    current = -1
    for p in range(first, last):
        if links[p] != current:
            current = links[p]
            _scale(world_from_links[current], lattice, voxels_from_link)
        x, y, z = moved(voxels_from_link, points[p, 0], points[p, 1], points[p, 2])
        if 0.0 <= x < lattice.nx and 0.0 <= y < lattice.ny and 0.0 <= z < lattice.nz:
            i, j, k = int(x), int(y), int(z)
            words[word_of(i, j, k, lattice.cubes_y, lattice.cubes_z)] |= bit_of(i, j, k)
