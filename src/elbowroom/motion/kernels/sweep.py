"""The swept check: the first interval of a motion in which a moving sample meets a blocked voxel."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, word_of
from elbowroom.machine.kernels.body import SLIDES, Tree, place_links
from elbowroom.motion.kernels.triangles import triangle_meets_box
from elbowroom.motion.kernels.volume import cell_of, counted, gap, leaves, meets_block, meets_voxel

ROUNDING_M = 1e-9
"""Added to every radius, so that rounding never makes a ball smaller than it is [m]."""

QUICK_BELOW = 0.499
"""Balls of smaller radius meet none but the eight voxels about the nearest corner [voxel edges]."""

TOGETHER = 64
"""So many samples are placed at once."""

EXACT_UP_TO = 2.0
"""Larger balls are tested against blocks of 64 voxels alone [voxel edges]."""

SURFACE, OUTSIDE, BLIND, UNSEEN, NOTHING = 0, 1, 2, 3, 4
"""What a block is, the most cautious first."""


class Course(NamedTuple):
    """Joint positions along a motion: straight lines between knots at rising travel."""

    travel: np.ndarray
    positions: np.ndarray


class Way(NamedTuple):
    """What moves, and where to: the tree, where it stands, joint positions along the motion, its length in travel."""

    tree: Tree
    world_from_base: np.ndarray
    course: Course
    length: float


class Skin(NamedTuple):
    """A machine's surface in its links' frames: samples, sorted by cluster, and triangles.

    A cluster lies on one link. The patch of a sample is the triangles that come within `cover` of it;
    together its patches are the surface.
    """

    points: np.ndarray
    cluster_of: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    link: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    cover: float
    triangles: np.ndarray
    patches: np.ndarray
    patch_start: np.ndarray


@njit
def place_at(tree, world_from_base, course, travel, world_from_link):
    """Fills world_from_link (1, links, 4, 4) for one place along a course."""
    last = course.travel.size - 2
    knot = 0
    while knot < last and travel > course.travel[knot + 1]:
        knot += 1
    share = (travel - course.travel[knot]) / (course.travel[knot + 1] - course.travel[knot])
    positions = np.empty((1, course.positions.shape[1]))
    for column in range(positions.shape[1]):
        start, stop = course.positions[knot, column], course.positions[knot + 1, column]
        positions[0, column] = start + share * (stop - start)
    place_links(tree, world_from_base, positions, world_from_link)


@njit(inline="always")
def _carried(transform, point):
    """A point of a link in the world."""
    x = transform[0, 0] * point[0] + transform[0, 1] * point[1] + transform[0, 2] * point[2] + transform[0, 3]
    y = transform[1, 0] * point[0] + transform[1, 1] * point[1] + transform[1, 2] * point[2] + transform[1, 3]
    z = transform[2, 0] * point[0] + transform[2, 1] * point[1] + transform[2, 2] * point[2] + transform[2, 3]
    return x, y, z


@njit(inline="always")
def _placed(placed, link, points, n):
    """Row n of an array of a link's points in the world: without views of arrays, for the inner loops."""
    a, b, c = float(points[n, 0]), float(points[n, 1]), float(points[n, 2])
    x = placed[link, 0, 0] * a + placed[link, 0, 1] * b + placed[link, 0, 2] * c + placed[link, 0, 3]
    y = placed[link, 1, 0] * a + placed[link, 1, 1] * b + placed[link, 1, 2] * c + placed[link, 1, 3]
    z = placed[link, 2, 0] * a + placed[link, 2, 1] * b + placed[link, 2, 2] * c + placed[link, 2, 3]
    return x, y, z


@njit(cache=True, nogil=True)
def bound_speeds(tree, rates, lengths, world_from_link, skin):
    """The most that any point of each cluster moves per unit of travel (see sweep.cluster_speeds).

    Args:
        rates: how fast the joint above each link moves per unit of travel, 0 if it does not, (links,).
        lengths: the farthest that each link's frame can be from its parent's, (links,).
        world_from_link: at the start, (links, 4, 4).
    """
    speeds = np.zeros(skin.link.size)
    for cluster in range(skin.link.size):
        row = skin.link[cluster]
        size = skin.radius[cluster] + skin.cover
        centre = skin.centre[cluster]
        x, y, z = _carried(world_from_link[row], centre)
        arm = math.sqrt(centre[0] ** 2 + centre[1] ** 2 + centre[2] ** 2) + size
        turned = False
        while row >= 0:
            if rates[row] > 0.0:
                if tree.kind[row] == SLIDES:
                    speeds[cluster] += rates[row]
                elif turned:
                    speeds[cluster] += rates[row] * arm
                else:
                    distance = _distance_to_axis(world_from_link[row], tree.axis[row], x, y, z)
                    speeds[cluster] += rates[row] * (distance + size)
                turned = True
            arm += lengths[row]
            row = tree.parent[row]
    return speeds


@njit
def _distance_to_axis(world_from_joint, axis_in_joint, x, y, z):
    """Distance of a point from the axis through a joint's frame."""
    a, b, c = _carried(world_from_joint, axis_in_joint)
    ox, oy, oz = world_from_joint[0, 3], world_from_joint[1, 3], world_from_joint[2, 3]
    a, b, c, x, y, z = a - ox, b - oy, c - oz, x - ox, y - oy, z - oz
    return math.sqrt((y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2)


@njit
def _near_clusters(placed, skin, speeds, half, volume, cells, asked, near):
    """The clusters among `asked` that may meet a block within half an interval either way; how many."""
    link, centre, radius, cover = skin.link, skin.centre, skin.radius, skin.cover
    words, cubes = volume.words, volume.cubes
    count = 0
    for n in range(asked.size):
        cluster = asked[n]
        x, y, z = _placed(placed, link[cluster], centre, cluster)
        r = radius[cluster] + cover + speeds[cluster] * half + ROUNDING_M
        if not meets_block(words, cubes, cells, x, y, z, r):
            continue
        if r > EXACT_UP_TO * cells.edge or meets_voxel(words, cells, x, y, z, r):
            near[count] = cluster
            count += 1
    return count


@njit
def _near_samples(placed, skin, speeds, half, volume, cells, asked, near):
    """The same for samples."""
    link, points, cluster_of, cover = skin.link, skin.points, skin.cluster_of, skin.cover
    words = volume.words
    count = 0
    for n in range(asked.size):
        sample = asked[n]
        cluster = cluster_of[sample]
        x, y, z = _placed(placed, link[cluster], points, sample)
        if meets_voxel(words, cells, x, y, z, cover + speeds[cluster] * half + ROUNDING_M):
            near[count] = sample
            count += 1
    return count


@njit
def _near_members(placed, skin, speeds, half, volume, cells, clusters, near):
    """The same for all samples of some clusters.

    A ball smaller than a voxel meets none but the eight voxels about the corner nearest to its centre: one look at
    what is known of that corner settles most of them.
    """
    link, points, start, stop, cover = skin.link, skin.points, skin.start, skin.stop, skin.cover
    words, corners = volume.words, volume.corners
    at = np.empty((3, TOGETHER), dtype=np.int32)
    count = 0
    for cluster in clusters:
        r = cover + speeds[cluster] * half + ROUNDING_M
        small = r < QUICK_BELOW * cells.edge
        for first in range(start[cluster], stop[cluster], TOGETHER):
            last = min(first + TOGETHER, stop[cluster])
            if small:
                _corners_of(placed, link[cluster], points, first, last, cells, at)
            for sample in range(first, last):
                n = sample - first
                if small and at[0, n] >= 0:
                    word = word_of(at[0, n], at[1, n], at[2, n], cells.cubes_y, cells.cubes_z)
                    if not corners[word] & bit_of(at[0, n], at[1, n], at[2, n]):
                        continue
                x, y, z = _placed(placed, link[cluster], points, sample)
                if meets_voxel(words, cells, x, y, z, r):
                    near[count] = sample
                    count += 1
    return count


@njit(error_model="numpy")
def _corners_of(placed, link, points, first, last, cells, at):
    """The voxels' corners nearest to a link's points: (3, points) int32, -1 for one on the grid's border or beyond."""
    scale = 1.0 / cells.edge
    for axis in range(3):
        corner = cells.x0 if axis == 0 else cells.y0 if axis == 1 else cells.z0
        end = np.float64(cells.nx if axis == 0 else cells.ny if axis == 1 else cells.nz)
        a, b = placed[link, axis, 0] * scale, placed[link, axis, 1] * scale
        c, d = placed[link, axis, 2] * scale, (placed[link, axis, 3] - corner) * scale + 0.5
        for n in range(last - first):
            u = np.uint64(first + n)
            place = a * points[u, 0] + b * points[u, 1] + c * points[u, 2] + d
            # comparisons with what is not a number are false
            at[axis, np.uint64(n)] = np.int32(place if (place >= 1.0) & (place < end) else -1.0)
    for n in range(last - first):
        u = np.uint64(n)
        at[0, u] = at[0, u] if (at[1, u] >= 0) & (at[2, u] >= 0) else -1


@njit
def _leaves_patch(transform, skin, sample, grown, cells):
    """Whether a corner of a sample's patch comes within `grown` of leaving the grid."""
    for n in range(skin.patch_start[sample], skin.patch_start[sample + 1]):
        for corner in range(3):
            x, y, z = _carried(transform, skin.triangles[skin.patches[n], corner])
            if leaves(x, y, z, grown, cells):
                return True
    return False


@njit
def _meets_patch(transform, skin, sample, x, y, z, half_edge, corners):
    """Whether a sample's patch meets a cube; `corners` (3, 3) is scratch."""
    for n in range(skin.patch_start[sample], skin.patch_start[sample + 1]):
        for corner in range(3):
            a, b, c = _carried(transform, skin.triangles[skin.patches[n], corner])
            corners[corner, 0], corners[corner, 1], corners[corner, 2] = a, b, c
        if triangle_meets_box(corners, x, y, z, half_edge):
            return True
    return False


@njit(inline="always")
def _kind(volume, word, bit):
    """What a blocked voxel is."""
    if volume.surface[word] & bit:
        return SURFACE
    if volume.blind[word] & bit:
        return BLIND
    if volume.disputed[word] & bit:
        return SURFACE
    return UNSEEN


@njit
def touched_block(placed, skin, speeds, half, volume, cells, samples, place):
    """The most cautious block that samples' patches meet, grown by their movement: what, by which cluster.

    Exact but for that growth: triangles against voxels. Fills `place` (3,) with the voxel's centre, or the
    sample whose patch leaves the grid [m].
    """
    found, by = NOTHING, -1
    corners = np.empty((3, 3))
    for sample in samples:
        cluster = skin.cluster_of[sample]
        transform = placed[skin.link[cluster]]
        x, y, z = _carried(transform, skin.points[sample])
        grown = speeds[cluster] * half + ROUNDING_M
        r = skin.cover + grown
        if leaves(x, y, z, r, cells) and _leaves_patch(transform, skin, sample, grown, cells):
            if found > OUTSIDE:
                found, by = OUTSIDE, cluster
                place[0], place[1], place[2] = x, y, z
            continue
        u, v, w, s = counted(x, y, z, r, cells)
        for i in range(cell_of(u - s, cells.nx), cell_of(u + s, cells.nx) + 1):
            du = gap(u, i * 1.0, i + 1.0)
            for j in range(cell_of(v - s, cells.ny), cell_of(v + s, cells.ny) + 1):
                dv = gap(v, j * 1.0, j + 1.0)
                for k in range(cell_of(w - s, cells.nz), cell_of(w + s, cells.nz) + 1):
                    dw = gap(w, k * 1.0, k + 1.0)
                    word, bit = word_of(i, j, k, cells.cubes_y, cells.cubes_z), bit_of(i, j, k)
                    if not volume.words[word] & bit or du * du + dv * dv + dw * dw > s * s:
                        continue
                    kind = _kind(volume, word, bit)
                    if kind >= found:
                        continue
                    a = cells.x0 + (i + 0.5) * cells.edge
                    b = cells.y0 + (j + 0.5) * cells.edge
                    c = cells.z0 + (k + 0.5) * cells.edge
                    if _meets_patch(transform, skin, sample, a, b, c, cells.edge / 2 + grown, corners):
                        found, by = kind, cluster
                        place[0], place[1], place[2] = a, b, c
        if found == SURFACE:
            break
    return found, by


@njit(cache=True, nogil=True)
def first_block(way, skin, speeds, moving, volume, cells, halvings):
    """The first of 2^n equal intervals of a way in which the machine meets a block.

    An interval is tested at its middle, every ball grown by the most that it moves in half of it (`speeds`,
    per cluster, times half its length). Where no ball meets a block the interval is free; else its halves are
    looked at, the earlier one first, with the balls that are left: clusters down to `sample_depth` halvings,
    samples from there, and in the shortest intervals the samples' triangles.

    Args:
        way: `Way`.
        skin: `Skin`.
        speeds: of each cluster, the most that it moves per unit of travel.
        moving: the clusters that move.
        volume, cells: what is blocked, and its grid.
        halvings: how many for clusters, and how many in all, n.

    Returns:
        The interval's index, -1 for none; what the block is, the cluster that meets it, and where (3,) [m].
    """
    tree, world_from_base, course, length = way
    sample_depth, depth_limit = halvings
    total = 0
    for cluster in moving:
        total += skin.stop[cluster] - skin.start[cluster]
    clusters = np.empty((sample_depth + 2, moving.size), dtype=np.int32)
    samples = np.empty((depth_limit - sample_depth + 2, total), dtype=np.int32)
    counts = np.zeros(depth_limit + 1, dtype=np.int64)
    placed = np.empty((1, tree.parent.size, 4, 4))
    place = np.zeros(3)
    for n in range(moving.size):
        clusters[0, n] = moving[n]
    depth, index = 0, 0
    while True:
        half = length / 2.0 ** (depth + 1)
        place_at(tree, world_from_base, course, (2 * index + 1) * half, placed)
        row = depth - sample_depth
        before = moving.size if depth == 0 else counts[depth - 1]
        if row <= 0:
            asked, near = clusters[depth, :before], clusters[depth + 1]
            left = _near_clusters(placed[0], skin, speeds, half, volume, cells, asked, near)
            if row == 0:
                left = _near_members(placed[0], skin, speeds, half, volume, cells, near[:left], samples[1])
        else:
            asked, near = samples[row, :before], samples[row + 1]
            left = _near_samples(placed[0], skin, speeds, half, volume, cells, asked, near)
        if left > 0 and depth == depth_limit:
            kind, by = touched_block(
                placed[0], skin, speeds, half, volume, cells, samples[row + 1, :left], place
            )
            if kind != NOTHING:
                return index, kind, by, place
        elif left > 0:
            counts[depth] = left
            depth, index = depth + 1, index * 2
            continue
        while index & 1:
            depth, index = depth - 1, index >> 1
        if depth == 0:
            return -1, NOTHING, -1, place
        index += 1
