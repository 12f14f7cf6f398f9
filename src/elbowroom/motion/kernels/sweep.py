"""The swept check: the first interval of a motion in which a moving sample meets a blocked voxel."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import bit_of, uncounted, word_of
from elbowroom.geometry.kernels.rigid import moved
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


class Mover(NamedTuple):
    """A machine on its way: its tree and where its base stands, (4, 4), its skin, where it goes, and the most that each
    cluster of the skin moves per unit of travel, (clusters,)."""

    tree: Tree
    world_from_base: np.ndarray
    skin: Skin
    course: Course
    speeds: np.ndarray


class Patch(NamedTuple):
    """The triangles about a sample: where its link is, by how much they are grown [m], of which skin and sample."""

    world_from_link: np.ndarray
    grown: float
    skin: Skin
    sample: int


class Halvings(NamedTuple):
    """How often an interval is cut in half: so often while clusters are asked, and at most."""

    of_clusters: int
    most: int


class Asked(NamedTuple):
    """What is left to ask at each depth of cutting, a row each, and room to work in.

    Fields:
        clusters: row d is asked at depth d, int32.
        samples: row d is asked d depths deeper than the last of the clusters, int32; row 0 is not used.
        counts: how many are left after each depth, int64.
        corners: of the voxels nearest to some samples, (3, `TOGETHER`) int32.
        triangle: (3, 3).
    """

    clusters: np.ndarray
    samples: np.ndarray
    counts: np.ndarray
    corners: np.ndarray
    triangle: np.ndarray


@njit
def place_at(mover, travel, world_from_links):
    """Fills world_from_links (1, links, 4, 4) for one place along a mover's course."""
    course = mover.course
    last = course.travel.size - 2
    knot = 0
    while knot < last and travel > course.travel[knot + 1]:
        knot += 1
    share = (travel - course.travel[knot]) / (course.travel[knot + 1] - course.travel[knot])
    positions = np.empty((1, course.positions.shape[1]))
    for column in range(positions.shape[1]):
        start, stop = course.positions[knot, column], course.positions[knot + 1, column]
        positions[0, column] = start + share * (stop - start)
    place_links(mover.tree, mover.world_from_base, positions, world_from_links)


@njit(inline="always")
def _carried(world_from_link, point):
    """A point of a link in the world."""
    return moved(world_from_link, point[0], point[1], point[2])


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


@uncounted()
def _near_clusters(placed, mover, half, volume, asked, near):
    """The clusters among `asked` that may meet a block within half an interval either way; how many."""
    skin, speeds = mover.skin, mover.speeds
    link, centre, radius, cover = skin.link, skin.centre, skin.radius, skin.cover
    words, cubes, lattice = volume.words, volume.cubes, volume.lattice
    count = 0
    for n in range(asked.size):
        cluster = asked[n]
        x, y, z = _placed(placed, link[cluster], centre, cluster)
        r = radius[cluster] + cover + speeds[cluster] * half + ROUNDING_M
        if not meets_block(words, cubes, lattice, x, y, z, r):
            continue
        if r > EXACT_UP_TO * lattice.edge or meets_voxel(words, lattice, x, y, z, r):
            near[count] = cluster
            count += 1
    return count


@uncounted()
def _near_samples(placed, mover, half, volume, asked, near):
    """The same for samples."""
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
def _near_members(placed, mover, half, volume, clusters, near, at):
    """The same for all samples of some clusters.

    A ball smaller than a voxel meets none but the eight voxels about the corner nearest to its centre: one look at
    what is known of that corner settles most of them. `at` (3, `TOGETHER`) is room to work in.
    """
    skin, speeds = mover.skin, mover.speeds
    link, points, start, stop, cover = skin.link, skin.points, skin.start, skin.stop, skin.cover
    words, corners, lattice = volume.words, volume.corners, volume.lattice
    count = 0
    for cluster in clusters:
        r = cover + speeds[cluster] * half + ROUNDING_M
        small = r < QUICK_BELOW * lattice.edge
        for first in range(start[cluster], stop[cluster], TOGETHER):
            last = min(first + TOGETHER, stop[cluster])
            if small:
                _corners_of(placed, link[cluster], points, first, last, lattice, at)
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
def _corners_of(placed, link, points, first, last, lattice, at):
    """The voxels' corners nearest to a link's points: (3, points) int32, -1 for one on the grid's border or beyond."""
    scale = 1.0 / lattice.edge
    for axis in range(3):
        corner = lattice.x0 if axis == 0 else lattice.y0 if axis == 1 else lattice.z0
        end = np.float64(lattice.nx if axis == 0 else lattice.ny if axis == 1 else lattice.nz)
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


@uncounted()
def _leaves_patch(patch, lattice):
    """Whether a corner of a patch, grown, leaves the grid."""
    skin = patch.skin
    for n in range(skin.patch_start[patch.sample], skin.patch_start[patch.sample + 1]):
        for corner in range(3):
            x, y, z = _carried(patch.world_from_link, skin.triangles[skin.patches[n], corner])
            if leaves(x, y, z, patch.grown, lattice):
                return True
    return False


@uncounted()
def _meets_patch(patch, x, y, z, half_edge, triangle):
    """Whether a patch, as it is, meets a cube; `triangle` (3, 3) is room to work in."""
    skin = patch.skin
    for n in range(skin.patch_start[patch.sample], skin.patch_start[patch.sample + 1]):
        for corner in range(3):
            a, b, c = _carried(patch.world_from_link, skin.triangles[skin.patches[n], corner])
            triangle[corner, 0], triangle[corner, 1], triangle[corner, 2] = a, b, c
        if triangle_meets_box(triangle, x, y, z, half_edge):
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


@uncounted()
def touched_block(placed, mover, half, volume, samples, place, triangle):
    """The most cautious block that samples' patches meet, grown by their movement: what, by which cluster.

    Exact but for that growth: triangles against voxels. Fills `place` (3,) with the voxel's centre, or the
    sample whose patch leaves the grid [m]; `triangle` (3, 3) is room to work in.
    """
    skin, lattice = mover.skin, volume.lattice
    found, by = NOTHING, -1
    for sample in samples:
        cluster = skin.cluster_of[sample]
        world_from_link = placed[skin.link[cluster]]
        x, y, z = _carried(world_from_link, skin.points[sample])
        grown = mover.speeds[cluster] * half + ROUNDING_M
        patch = Patch(world_from_link, grown, skin, sample)
        r = skin.cover + grown
        if leaves(x, y, z, r, lattice) and _leaves_patch(patch, lattice):
            if found > OUTSIDE:
                found, by = OUTSIDE, cluster
                place[0], place[1], place[2] = x, y, z
            continue
        kind = _touched_by(patch, counted(x, y, z, r, lattice), volume, found, place, triangle)
        if kind < found:
            found, by = kind, cluster
        if found == SURFACE:
            break
    return found, by


@uncounted()
def _touched_by(patch, ball, volume, found, place, triangle):
    """The most cautious block that a patch meets, if it is more cautious than what was found; else that.

    Args:
        ball: about the patch, centre and radius counted in voxels.
        place: (3,), written where there is such a block: its centre [m].
        triangle: (3, 3), room to work in.
    """
    lattice = volume.lattice
    u, v, w, s = ball
    for i in range(cell_of(u - s, lattice.nx), cell_of(u + s, lattice.nx) + 1):
        du = gap(u, i * 1.0, i + 1.0)
        for j in range(cell_of(v - s, lattice.ny), cell_of(v + s, lattice.ny) + 1):
            dv = gap(v, j * 1.0, j + 1.0)
            for k in range(cell_of(w - s, lattice.nz), cell_of(w + s, lattice.nz) + 1):
                dw = gap(w, k * 1.0, k + 1.0)
                word, bit = word_of(i, j, k, lattice.cubes_y, lattice.cubes_z), bit_of(i, j, k)
                if not volume.words[word] & bit or du * du + dv * dv + dw * dw > s * s:
                    continue
                kind = _kind(volume, word, bit)
                if kind >= found:
                    continue
                x, y, z = (
                    lattice.x0 + (i + 0.5) * lattice.edge,
                    lattice.y0 + (j + 0.5) * lattice.edge,
                    lattice.z0 + (k + 0.5) * lattice.edge,
                )
                if _meets_patch(patch, x, y, z, lattice.edge / 2 + patch.grown, triangle):
                    found = kind
                    place[0], place[1], place[2] = x, y, z
    return found


@njit(cache=True, nogil=True)
def first_block(tree, world_from_base, skin, course, length, speeds, volume, halvings):
    """The first of 2^halvings.most equal intervals of [0, length] in which the machine meets a block.

    An interval is tested at its middle, every ball grown by the most that it moves in half of it (its cluster's
    speed times half its length). Where no ball meets a block the interval is free; else its halves are looked at,
    the earlier one first, with the balls that are left: clusters down to `halvings.of_clusters`, samples from
    there, and in the shortest intervals the samples' triangles.

    Args:
        tree, world_from_base, skin, course, speeds: what moves, and how (`Mover`).
        length: travel that is looked at, at most the course's.
        volume: what is blocked.
        halvings: how often intervals are cut.

    Returns:
        The interval's index, -1 for none; what the block is, the cluster that meets it, and where (3,) [m].
    """
    # made here and not by the caller: a record in a record costs Python more to hand over than what it holds
    mover = Mover(tree, world_from_base, skin, course, speeds)
    asked = _all_moving(mover, halvings)
    placed = np.empty((1, mover.tree.parent.size, 4, 4))
    place = np.zeros(3)
    depth, index = 0, 0
    while True:
        half = length / 2.0 ** (depth + 1)
        place_at(mover, (2 * index + 1) * half, placed)
        left = _ask(placed[0], mover, half, volume, asked, depth, halvings)
        if left > 0 and depth == halvings.most:
            samples = asked.samples[depth - halvings.of_clusters + 1, :left]
            kind, by = touched_block(placed[0], mover, half, volume, samples, place, asked.triangle)
            if kind != NOTHING:
                return index, kind, by, place
        elif left > 0:
            asked.counts[depth] = left
            depth, index = depth + 1, index * 2
            continue
        # on to the later half of the interval that has one which was not looked at
        while index & 1:
            depth, index = depth - 1, index >> 1
        if depth == 0:
            return -1, NOTHING, -1, place
        index += 1


@njit
def _all_moving(mover, halvings):
    """What is asked first, all clusters that move, and room for what is left of them."""
    moving = np.flatnonzero(mover.speeds > 0.0)
    total = 0
    for cluster in moving:
        total += mover.skin.stop[cluster] - mover.skin.start[cluster]
    clusters = np.empty((halvings.of_clusters + 2, moving.size), dtype=np.int32)
    samples = np.empty((halvings.most - halvings.of_clusters + 2, total), dtype=np.int32)
    for n in range(moving.size):
        clusters[0, n] = moving[n]
    counts, corners = np.zeros(halvings.most + 1, dtype=np.int64), np.empty((3, TOGETHER), dtype=np.int32)
    return Asked(clusters, samples, counts, corners, np.empty((3, 3)))


@uncounted()
def _ask(placed, mover, half, volume, asked, depth, halvings):
    """How many of the clusters or samples asked at a depth may meet a block: they are what the next depth asks."""
    row = depth - halvings.of_clusters
    before = asked.clusters.shape[1] if depth == 0 else asked.counts[depth - 1]
    if row > 0:
        samples = asked.samples
        return _near_samples(placed, mover, half, volume, samples[row, :before], samples[row + 1])
    near = asked.clusters[depth + 1]
    left = _near_clusters(placed, mover, half, volume, asked.clusters[depth, :before], near)
    if row == 0:
        left = _near_members(placed, mover, half, volume, near[:left], asked.samples[1], asked.corners)
    return left
