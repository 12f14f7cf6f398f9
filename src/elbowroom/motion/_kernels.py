"""The swept check: the first interval of a motion in which a moving sample meets a blocked voxel."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry._kernels import bit_of, word_of
from elbowroom.machine._kernels import SLIDES, place_links

ROUNDING_M = 1e-9
"""Added to every radius, so that rounding never makes a ball smaller than it is [m]."""

SURFACE, OUTSIDE, BLIND, UNSEEN = 0, 1, 2, 3
"""What a block is, the most cautious first."""


class Course(NamedTuple):
    """Joint positions along a motion: straight lines between knots at rising travel."""

    travel: np.ndarray
    positions: np.ndarray


class Skin(NamedTuple):
    """Samples of the surface in their links' frames, sorted by cluster; a cluster lies on one link."""

    points: np.ndarray
    cluster_of: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    link: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    cover: float


class Volume(NamedTuple):
    """What is blocked: one bit a voxel, and for each 16-voxel cube whether any of its bits is set."""

    words: np.ndarray
    cubes: np.ndarray


@njit(cache=True, nogil=True)
def block(free, cells, words, cubes):
    """Fills the volume: blocked is every voxel of the grid that is not free."""
    for cube in range(cubes.size):
        i = cube // (cells.cubes_y * cells.cubes_z) * 16
        j = cube // cells.cubes_z % cells.cubes_y * 16
        k = cube % cells.cubes_z * 16
        whole = i + 16 <= cells.nx and j + 16 <= cells.ny and k + 16 <= cells.nz
        some = np.uint64(0)
        for w in range(64):
            blocked = ~free[cube * 64 + w]
            if not whole:
                blocked &= _inside(i + w // 16 * 4, j + w // 4 % 4 * 4, k + w % 4 * 4, cells)
            words[cube * 64 + w] = blocked
            some |= blocked
        cubes[cube] = some != 0


@njit
def _inside(i, j, k, cells):
    """The bits of a word, whose least voxel is (i, j, k), that lie in the grid."""
    if i + 4 <= cells.nx and j + 4 <= cells.ny and k + 4 <= cells.nz:
        return ~np.uint64(0)
    bits = np.uint64(0)
    for x in range(i, min(i + 4, cells.nx)):
        for y in range(j, min(j + 4, cells.ny)):
            for z in range(k, min(k + 4, cells.nz)):
                bits |= bit_of(x, y, z)
    return bits


@njit(inline="always")
def _gap(point, low, high):
    """Distance along one axis from a coordinate to an interval."""
    return max(low - point, 0.0, point - high)


@njit(inline="always")
def _leaves(x, y, z, r, cells):
    """Whether a ball reaches out of the grid; so does one whose place is not a number."""
    return not (
        x - r >= cells.x0
        and y - r >= cells.y0
        and z - r >= cells.z0
        and x + r <= cells.x0 + cells.nx * cells.edge
        and y + r <= cells.y0 + cells.ny * cells.edge
        and z + r <= cells.z0 + cells.nz * cells.edge
    )


@njit(inline="always")
def _cell(coordinate, count):
    """The cell of a coordinate counted in cells, held within the grid; it is known to be finite."""
    return int(min(max(coordinate, 0.0), count - 1.0))


@njit
def meets_block(volume, cells, x, y, z, r):
    """Whether a ball meets a word with a blocked voxel, or leaves the grid: a test for large balls."""
    if _leaves(x, y, z, r, cells):
        return True
    u, v, w, s = (
        (x - cells.x0) / cells.edge,
        (y - cells.y0) / cells.edge,
        (z - cells.z0) / cells.edge,
        r / cells.edge,
    )
    i0, i1 = _cell(u - s, cells.nx) >> 2, _cell(u + s, cells.nx) >> 2
    j0, j1 = _cell(v - s, cells.ny) >> 2, _cell(v + s, cells.ny) >> 2
    k0, k1 = _cell(w - s, cells.nz) >> 2, _cell(w + s, cells.nz) >> 2
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                cube = (a * cells.cubes_y + b) * cells.cubes_z + c
                if not volume.cubes[cube]:
                    continue
                for i in range(max(i0, a * 4), min(i1, a * 4 + 3) + 1):
                    du = _gap(u, i * 4.0, i * 4.0 + 4.0)
                    for j in range(max(j0, b * 4), min(j1, b * 4 + 3) + 1):
                        dv = _gap(v, j * 4.0, j * 4.0 + 4.0)
                        for k in range(max(k0, c * 4), min(k1, c * 4 + 3) + 1):
                            if volume.words[cube * 64 + ((i & 3) * 4 + (j & 3)) * 4 + (k & 3)] == 0:
                                continue
                            dw = _gap(w, k * 4.0, k * 4.0 + 4.0)
                            if du * du + dv * dv + dw * dw <= s * s:
                                return True
    return False


@njit
def meets_voxel(volume, cells, x, y, z, r):
    """Whether a ball meets a blocked voxel, or leaves the grid: exact, a test for balls of about a voxel."""
    if _leaves(x, y, z, r, cells):
        return True
    u, v, w, s = (
        (x - cells.x0) / cells.edge,
        (y - cells.y0) / cells.edge,
        (z - cells.z0) / cells.edge,
        r / cells.edge,
    )
    i0, i1 = _cell(u - s, cells.nx), _cell(u + s, cells.nx)
    j0, j1 = _cell(v - s, cells.ny), _cell(v + s, cells.ny)
    k0, k1 = _cell(w - s, cells.nz), _cell(w + s, cells.nz)
    for a in range(i0 >> 2, (i1 >> 2) + 1):
        for b in range(j0 >> 2, (j1 >> 2) + 1):
            for c in range(k0 >> 2, (k1 >> 2) + 1):
                word = volume.words[word_of(a * 4, b * 4, c * 4, cells.cubes_y, cells.cubes_z)]
                if word == 0:
                    continue
                for i in range(max(i0, a * 4), min(i1, a * 4 + 3) + 1):
                    du = _gap(u, i * 1.0, i + 1.0)
                    for j in range(max(j0, b * 4), min(j1, b * 4 + 3) + 1):
                        dv = _gap(v, j * 1.0, j + 1.0)
                        for k in range(max(k0, c * 4), min(k1, c * 4 + 3) + 1):
                            if word & bit_of(i, j, k):
                                dw = _gap(w, k * 1.0, k + 1.0)
                                if du * du + dv * dv + dw * dw <= s * s:
                                    return True
    return False


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
    count = 0
    for cluster in asked:
        x, y, z = _carried(placed[skin.link[cluster]], skin.centre[cluster])
        r = skin.radius[cluster] + skin.cover + speeds[cluster] * half + ROUNDING_M
        if meets_block(volume, cells, x, y, z, r):
            near[count] = cluster
            count += 1
    return count


@njit
def _near_samples(placed, skin, speeds, half, volume, cells, asked, near):
    """The same for samples."""
    count = 0
    for sample in asked:
        cluster = skin.cluster_of[sample]
        x, y, z = _carried(placed[skin.link[cluster]], skin.points[sample])
        if meets_voxel(volume, cells, x, y, z, skin.cover + speeds[cluster] * half + ROUNDING_M):
            near[count] = sample
            count += 1
    return count


@njit
def _members(skin, clusters, samples):
    """All samples of some clusters; how many."""
    count = 0
    for cluster in clusters:
        for sample in range(skin.start[cluster], skin.stop[cluster]):
            samples[count] = sample
            count += 1
    return count


@njit(cache=True, nogil=True)
def first_block(
    tree, world_from_base, course, length, skin, speeds, moving, volume, cells, sample_depth, depth_limit
):
    """Index of the first of 2^depth_limit equal intervals of [0, length] in which the machine may meet a
    block, or -1; with the samples that do.

    An interval is tested at its middle, every ball grown by the most that it moves in half of it (`speeds`,
    per cluster, times half its length). Where no ball meets a block the interval is free; else its halves are
    looked at, the earlier one first, with the balls that are left. Clusters down to `sample_depth` halvings,
    samples from there.
    """
    total = 0
    for cluster in moving:
        total += skin.stop[cluster] - skin.start[cluster]
    clusters = np.empty((sample_depth + 2, moving.size), dtype=np.int32)
    samples = np.empty((depth_limit - sample_depth + 2, total), dtype=np.int32)
    counts = np.zeros(depth_limit + 2, dtype=np.int64)
    placed = np.empty((1, tree.parent.size, 4, 4))
    clusters[0] = moving
    members = moving.size
    depth, index = 0, 0
    while True:
        half = length / 2.0 ** (depth + 1)
        place_at(tree, world_from_base, course, (2 * index + 1) * half, placed)
        if depth <= sample_depth:
            asked = clusters[depth, : moving.size if depth == 0 else counts[depth - 1]]
            left = _near_clusters(placed[0], skin, speeds, half, volume, cells, asked, clusters[depth + 1])
            if depth == sample_depth and left > 0:
                members = _members(skin, clusters[depth + 1, :left], samples[0])
                left = _near_samples(
                    placed[0], skin, speeds, half, volume, cells, samples[0, :members], samples[1]
                )
        else:
            row = depth - sample_depth
            asked = samples[row, : counts[depth - 1]]
            left = _near_samples(placed[0], skin, speeds, half, volume, cells, asked, samples[row + 1])
        if left > 0 and depth == depth_limit:
            return index, samples[depth - sample_depth + 1, :left].copy()
        if left > 0:
            counts[depth] = left
            depth, index = depth + 1, index * 2
            continue
        while index & 1:
            depth, index = depth - 1, index >> 1
        if depth == 0:
            return -1, np.empty(0, dtype=np.int32)
        index += 1


@njit(cache=True, nogil=True)
def explain_block(placed, skin, speeds, half, volume, surface, blind, disputed, cells, samples):
    """The most cautious block that samples meet: what it is, the cluster that meets it, where (3,) [m].

    Args:
        placed: world_from_link at the middle of the interval, (links, 4, 4).
        half: half the interval's length.
        surface, blind, disputed: planes of the free space.
        samples: those that meet a block.
    """
    found, by = UNSEEN + 1, -1
    place = np.zeros(3)
    for sample in samples:
        cluster = skin.cluster_of[sample]
        x, y, z = _carried(placed[skin.link[cluster]], skin.points[sample])
        r = skin.cover + speeds[cluster] * half + ROUNDING_M
        if _leaves(x, y, z, r, cells):
            if found > OUTSIDE:
                found, by = OUTSIDE, cluster
                place[0], place[1], place[2] = x, y, z
            continue
        u, v, w, s = (
            (x - cells.x0) / cells.edge,
            (y - cells.y0) / cells.edge,
            (z - cells.z0) / cells.edge,
            r / cells.edge,
        )
        for i in range(_cell(u - s, cells.nx), _cell(u + s, cells.nx) + 1):
            du = _gap(u, i * 1.0, i + 1.0)
            for j in range(_cell(v - s, cells.ny), _cell(v + s, cells.ny) + 1):
                dv = _gap(v, j * 1.0, j + 1.0)
                for k in range(_cell(w - s, cells.nz), _cell(w + s, cells.nz) + 1):
                    dw = _gap(w, k * 1.0, k + 1.0)
                    word, bit = word_of(i, j, k, cells.cubes_y, cells.cubes_z), bit_of(i, j, k)
                    if not volume.words[word] & bit or du * du + dv * dv + dw * dw > s * s:
                        continue
                    kind = UNSEEN
                    if surface[word] & bit:
                        kind = SURFACE
                    elif blind[word] & bit:
                        kind = BLIND
                    elif disputed[word] & bit:
                        kind = SURFACE
                    if kind < found:
                        found, by = kind, cluster
                        place[0] = cells.x0 + (i + 0.5) * cells.edge
                        place[1] = cells.y0 + (j + 0.5) * cells.edge
                        place[2] = cells.z0 + (k + 0.5) * cells.edge
    return found, by, place
