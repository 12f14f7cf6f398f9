"""Which clusters and samples of a moving skin may meet a block: boxes and balls against voxels."""

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, uncounted, word_of
from elbowroom.motion.kernels.mover import ROUNDING_M
from elbowroom.motion.kernels.sway import sway
from elbowroom.motion.kernels.volume import meets_in_box, meets_voxel

QUICK_BELOW = 0.499
"""Balls of smaller radius meet none but the eight voxels about the nearest corner [voxel edges]."""

TOGETHER = 64
"""So many samples are placed at once."""


@njit(inline="always")
def _placed(placed, link, points, n):
    """Row n of an array of a link's points in the world: without views of arrays, for the inner loops."""
    a, b, c = float(points[n, 0]), float(points[n, 1]), float(points[n, 2])
    x = placed[link, 0, 0] * a + placed[link, 0, 1] * b + placed[link, 0, 2] * c + placed[link, 0, 3]
    y = placed[link, 1, 0] * a + placed[link, 1, 1] * b + placed[link, 1, 2] * c + placed[link, 1, 3]
    z = placed[link, 2, 0] * a + placed[link, 2, 1] * b + placed[link, 2, 2] * c + placed[link, 2, 3]
    return x, y, z


@uncounted()
def near_boxes(placed, mover, turns, spare, volume, asked, near, ways):
    """The clusters among `asked` that may meet a block within a box of joint positions; how many.

    Each is a box along the axes of the world about its samples, as far as joints carry it (`sway`): where it lies flat
    or slides along something, it is asked of much less space than by the ball about it.

    Args:
        placed: where links are in the box's middle, (links, 4, 4).
        mover: what moves.
        turns: the most that joints change, (joints,).
        spare: by so much, times its speed, a cluster's samples are grown besides.
        volume: what is blocked.
        asked: which, int32.
        near: written, int32.
        ways: (rows of a tree, 3), room to work in.
    """
    skin, speeds, cover = mover.skin, mover.speeds, mover.skin.cover + mover.skin.off + 2 * ROUNDING_M
    words, cubes, lattice = volume.words, volume.cubes, volume.lattice
    count = 0
    for n in range(asked.size):
        cluster = asked[n]
        link, half = skin.link[cluster], skin.half
        middle = _placed(placed, link, skin.centre, cluster)
        ball = (middle[0], middle[1], middle[2], skin.radius[cluster] + cover)
        moving, rest = sway(mover.tree, placed, turns, link, ball, ways)
        rx = ry = rz = cover + rest + speeds[cluster] * spare
        for axis in range(3):
            rx += abs(placed[link, 0, axis]) * half[cluster, axis]
            ry += abs(placed[link, 1, axis]) * half[cluster, axis]
            rz += abs(placed[link, 2, axis]) * half[cluster, axis]
        for row in range(moving):
            rx, ry, rz = rx + abs(ways[row, 0]), ry + abs(ways[row, 1]), rz + abs(ways[row, 2])
        if meets_in_box(words, cubes, lattice, middle, (rx, ry, rz)):
            near[count] = cluster
            count += 1
    return count


@uncounted()
def near_samples(placed, mover, half, volume, asked, near):
    """The samples among `asked` whose balls may meet a block within half an interval either way; how many."""
    skin, speeds = mover.skin, mover.speeds
    link, points, cluster_of, cover = skin.link, skin.points, skin.cluster_of, skin.cover
    words, lattice = volume.words, volume.lattice
    count = 0
    for n in range(asked.size):
        sample = asked[n]
        cluster = cluster_of[sample]
        x, y, z = _placed(placed, link[cluster], points, sample)
        if meets_voxel(words, lattice, x, y, z, cover + speeds[cluster] * half + ROUNDING_M):
            near[count] = sample
            count += 1
    return count


@uncounted()
def near_members(placed, mover, half, volume, clusters, near, at):
    """The same for all samples of some clusters.

    A ball smaller than a voxel meets none but the eight voxels about the corner nearest to its centre: one look at
    what is known of that corner settles most of them. `at` (3, `TOGETHER`) is room to work in.
    """
    skin, speeds = mover.skin, mover.speeds
    link, points, start, stop, cover = skin.link, skin.points, skin.start, skin.stop, skin.cover
    columns = skin.columns
    words, corners, lattice = volume.words, volume.corners, volume.lattice
    count = 0
    for cluster in clusters:
        r = cover + speeds[cluster] * half + ROUNDING_M
        small = r < QUICK_BELOW * lattice.edge
        for first in range(start[cluster], stop[cluster], TOGETHER):
            last = min(first + TOGETHER, stop[cluster])
            if small:
                _corners_of(placed, link[cluster], columns, first, last, lattice, at)
            for sample in range(first, last):
                n = sample - first
                if small and at[0, n] >= 0:
                    word = word_of(at[0, n], at[1, n], at[2, n], lattice.cubes_y, lattice.cubes_z)
                    if not corners[word] & bit_of(at[0, n], at[1, n], at[2, n]):
                        continue
                x, y, z = _placed(placed, link[cluster], points, sample)
                if meets_voxel(words, lattice, x, y, z, r):
                    near[count] = sample
                    count += 1
    return count


@uncounted(error_model="numpy")
def _corners_of(placed, link, columns, first, last, lattice, at):
    """The voxels' corners nearest to a link's points: (3, points) int32, -1 for one on the grid's border or beyond."""
    scale = 1.0 / lattice.edge
    for axis in range(3):
        corner = lattice.x0 if axis == 0 else lattice.y0 if axis == 1 else lattice.z0
        end = np.float64(lattice.nx if axis == 0 else lattice.ny if axis == 1 else lattice.nz)
        a, b = placed[link, axis, 0] * scale, placed[link, axis, 1] * scale
        c, d = placed[link, axis, 2] * scale, (placed[link, axis, 3] - corner) * scale + 0.5
        for n in range(last - first):
            u = np.uint64(first + n)
            place = a * columns[0, u] + b * columns[1, u] + c * columns[2, u] + d
            # comparisons with what is not a number are false
            at[axis, np.uint64(n)] = np.int32(place if (place >= 1.0) & (place < end) else -1.0)
    for n in range(last - first):
        u = np.uint64(n)
        at[0, u] = at[0, u] if (at[1, u] >= 0) & (at[2, u] >= 0) else -1
