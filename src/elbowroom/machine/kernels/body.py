"""Where links are, and which voxels a body covers: arrays in, arrays out."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, word_of

FIXED, SLIDES, TURNS = 0, 1, 2
MAX_BLOCKS = 4096


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
    """Surface samples in clusters: cluster c is points[start[c] : stop[c]], on one link, in a sphere.

    points: (n, 3) in the frame of their link [m]. link, centre, radius: of each cluster.
    """

    points: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    link: np.ndarray
    centre: np.ndarray
    radius: np.ndarray


@njit(cache=True, nogil=True)
def place_links(tree, world_from_base, positions, world_from_link):
    """Forward kinematics: fills world_from_link (n, links, 4, 4) for positions (n, joints)."""
    moved = np.empty((3, 4))
    for n in range(positions.shape[0]):
        for row in range(tree.parent.size):
            parent = tree.parent[row]
            if parent < 0:
                for i in range(4):
                    for j in range(4):
                        world_from_link[n, row, i, j] = world_from_base[i, j]
                continue
            fixed = tree.parent_from_joint[row]
            if tree.kind[row] == FIXED:
                for i in range(3):
                    for j in range(4):
                        moved[i, j] = fixed[i, j]
            else:
                position = positions[n, tree.column[row]] * tree.multiplier[row] + tree.offset[row]
                _move(fixed, tree.axis[row], position, tree.kind[row] == SLIDES, moved)
            above = world_from_link[n, parent]
            out = world_from_link[n, row]
            for i in range(3):
                for j in range(4):
                    out[i, j] = (
                        above[i, 0] * moved[0, j] + above[i, 1] * moved[1, j] + above[i, 2] * moved[2, j]
                    )
                out[i, 3] += above[i, 3]
                out[3, i] = 0.0
            out[3, 3] = 1.0


@njit(nogil=True)
def _move(fixed, axis, position, slides, moved):
    """moved = fixed @ (slide along or turn about the axis); Rodrigues' formula for the turn."""
    x, y, z = axis[0], axis[1], axis[2]
    if slides:
        for i in range(3):
            for j in range(3):
                moved[i, j] = fixed[i, j]
            moved[i, 3] = fixed[i, 3] + position * (fixed[i, 0] * x + fixed[i, 1] * y + fixed[i, 2] * z)
    else:
        c, s = math.cos(position), math.sin(position)
        d = 1.0 - c
        for i in range(3):
            a, b, e = fixed[i, 0], fixed[i, 1], fixed[i, 2]
            moved[i, 0] = a * (c + x * x * d) + b * (x * y * d + z * s) + e * (x * z * d - y * s)
            moved[i, 1] = a * (x * y * d - z * s) + b * (c + y * y * d) + e * (y * z * d + x * s)
            moved[i, 2] = a * (x * z * d + y * s) + b * (y * z * d - x * s) + e * (c + z * z * d)
            moved[i, 3] = fixed[i, 3]


@njit(cache=True, nogil=True)
def mark_balls(samples, share, shares, world_from_link, cells, reach, words):
    """Sets the voxels that balls about surface samples meet: those whose box lies within `reach` of a sample.

    A ball of half a voxel's radius at most meets only voxels of the 2 x 2 x 2 block about the grid corner
    nearest to its middle. A cluster notes eight bits for each such corner first, and sets the voxels at its
    end.

    Args:
        samples: `Clusters`.
        share, shares: does every shares-th cluster from share on.
        world_from_link: (links, 4, 4).
        cells: the voxel grid.
        reach: radius of the balls [m].
        words: the plane to set bits in.
    """
    points, starts, stops, link, centre, radius = samples
    scale = 1.0 / cells.edge
    r = reach * scale
    blocks = np.zeros(MAX_BLOCKS, dtype=np.uint8)
    rows = np.empty((3, 4))
    for c in range(share, starts.size, shares):
        _voxels_from_link(world_from_link[link[c]], cells, rows)
        x, y, z = _moved(rows, centre[c, 0], centre[c, 1], centre[c, 2])
        around = radius[c] * scale + 1e-6
        if not (-around - r <= x <= cells.nx + around + r and -around - r <= y <= cells.ny + around + r):
            continue
        if not -around - r <= z <= cells.nz + around + r:
            continue
        i0, i1 = math.floor(x - around - 0.5), math.floor(x + around - 0.5)
        j0, j1 = math.floor(y - around - 0.5), math.floor(y + around - 0.5)
        k0, k1 = math.floor(z - around - 0.5), math.floor(z + around - 0.5)
        ny, nz = j1 - j0 + 1, k1 - k0 + 1
        count = (i1 - i0 + 1) * ny * nz
        if r > 0.5 or count > MAX_BLOCKS:
            for p in range(starts[c], stops[c]):
                x, y, z = _moved(rows, points[p, 0], points[p, 1], points[p, 2])
                _mark_ball(x, y, z, r, cells, words)
            continue
        for p in range(starts[c], stops[c]):
            x, y, z = _moved(rows, points[p, 0], points[p, 1], points[p, 2])
            i, j, k = math.floor(x - 0.5), math.floor(y - 0.5), math.floor(z - 0.5)
            place = ((i - i0) * ny + (j - j0)) * nz + (k - k0)
            blocks[place] |= _block_met(x - i - 1.0, y - j - 1.0, z - k - 1.0, r * r)
        for place in range(count):
            if blocks[place] != 0:
                i, j, k = i0 + place // (ny * nz), j0 + place // nz % ny, k0 + place % nz
                _set_block(i, j, k, blocks[place], cells, words)
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
def _set_block(i, j, k, block, cells, words):
    """Sets the voxels from (i, j, k) on whose bits stand in `block`, as far as they are in the grid."""
    for n in range(8):
        if (block >> n) & 1:
            a, b, c = i + (n >> 2), j + ((n >> 1) & 1), k + (n & 1)
            if 0 <= a < cells.nx and 0 <= b < cells.ny and 0 <= c < cells.nz:
                words[word_of(a, b, c, cells.cubes_y, cells.cubes_z)] |= bit_of(a, b, c)


@njit(nogil=True)
def _voxels_from_link(world_from_link, cells, rows):
    """The pose's three rows, in voxels from the grid's corner."""
    scale = 1.0 / cells.edge
    for j in range(4):
        for i in range(3):
            rows[i, j] = world_from_link[i, j] * scale
    rows[0, 3] -= cells.x0 * scale
    rows[1, 3] -= cells.y0 * scale
    rows[2, 3] -= cells.z0 * scale


@njit(nogil=True)
def _moved(rows, a, b, c):
    """A point moved by three rows of a transform."""
    return (
        rows[0, 0] * a + rows[0, 1] * b + rows[0, 2] * c + rows[0, 3],
        rows[1, 0] * a + rows[1, 1] * b + rows[1, 2] * c + rows[1, 3],
        rows[2, 0] * a + rows[2, 1] * b + rows[2, 2] * c + rows[2, 3],
    )


@njit(nogil=True)
def _mark_ball(x, y, z, r, cells, words):
    """Sets the voxels that a ball about (x, y, z) meets, all in voxels from the grid's corner."""
    if not (-r <= x < cells.nx + r and -r <= y < cells.ny + r and -r <= z < cells.nz + r):
        return
    i0, i1 = max(0, math.floor(x - r)), min(cells.nx - 1, math.floor(x + r))
    j0, j1 = max(0, math.floor(y - r)), min(cells.ny - 1, math.floor(y + r))
    k0, k1 = max(0, math.floor(z - r)), min(cells.nz - 1, math.floor(z + r))
    for i in range(i0, i1 + 1):
        dx = max(i - x, x - i - 1.0, 0.0)
        for j in range(j0, j1 + 1):
            dy = max(j - y, y - j - 1.0, 0.0)
            for k in range(k0, k1 + 1):
                dz = max(k - z, z - k - 1.0, 0.0)
                if dx * dx + dy * dy + dz * dz <= r * r:
                    words[word_of(i, j, k, cells.cubes_y, cells.cubes_z)] |= bit_of(i, j, k)


@njit(cache=True, nogil=True)
def mark_points(points, link, first, last, world_from_link, cells, words):
    """Sets the voxels that hold the points first to last; `link`: the row in world_from_link of each."""
    rows = np.empty((3, 4))
    current = -1
    for p in range(first, last):
        if link[p] != current:
            current = link[p]
            _voxels_from_link(world_from_link[current], cells, rows)
        x, y, z = _moved(rows, points[p, 0], points[p, 1], points[p, 2])
        if 0.0 <= x < cells.nx and 0.0 <= y < cells.ny and 0.0 <= z < cells.nz:
            i, j, k = int(x), int(y), int(z)
            words[word_of(i, j, k, cells.cubes_y, cells.cubes_z)] |= bit_of(i, j, k)
