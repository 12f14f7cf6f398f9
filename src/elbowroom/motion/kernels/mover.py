"""A machine on its way: its skin, its course, where its links are along it, and how fast its points move."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.rigid import moved
from elbowroom.machine.kernels.body import SLIDES, Tree, place_links

ROUNDING_M = 1e-9
"""Added to every radius, so that rounding never makes a ball smaller than it is [m]."""


class Course(NamedTuple):
    """Joint positions along a motion: straight lines between knots at rising travel."""

    travel: np.ndarray
    positions: np.ndarray


class Skin(NamedTuple):
    """A machine's surface in its links' frames: samples, sorted by cluster, and triangles.

    A cluster lies on one link, its samples no farther from its centre than `half` along each axis. The patch
    of a sample is the triangles that come within `cover` of it; together its patches are the surface, or lie off it by
    `off` at most. `columns` are the points again, (3, n): loops over many at once read them five times as fast so; none
    in skins that are not swept.
    """

    points: np.ndarray
    cluster_of: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    link: np.ndarray
    centre: np.ndarray
    radius: np.ndarray
    half: np.ndarray
    cover: float
    off: float
    triangles: np.ndarray
    patches: np.ndarray
    patch_start: np.ndarray
    columns: np.ndarray


class Mover(NamedTuple):
    """A machine on its way: its tree and where its base stands, (4, 4), its skin, where it goes, and the most that each
    cluster of the skin moves per unit of travel, (clusters,)."""

    tree: Tree
    world_from_base: np.ndarray
    skin: Skin
    course: Course
    speeds: np.ndarray


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
def carried(world_from_link, point):
    """A point of a link in the world."""
    return moved(world_from_link, point[0], point[1], point[2])


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
        x, y, z = carried(world_from_link[row], centre)
        arm = math.sqrt(centre[0] ** 2 + centre[1] ** 2 + centre[2] ** 2) + size
        turned = False
        while row >= 0:
            if rates[row] > 0.0:
                if tree.kind[row] == SLIDES:
                    speeds[cluster] += rates[row]
                elif turned:
                    speeds[cluster] += rates[row] * arm
                else:
                    distance = distance_to_axis(world_from_link[row], tree.axis[row], x, y, z)
                    speeds[cluster] += rates[row] * (distance + size)
                turned = True
            arm += lengths[row]
            row = tree.parent[row]
    return speeds


@njit
def distance_to_axis(world_from_joint, axis_in_joint, x, y, z):
    """Distance of a point from the axis through a joint's frame."""
    a, b, c = carried(world_from_joint, axis_in_joint)
    ox, oy, oz = world_from_joint[0, 3], world_from_joint[1, 3], world_from_joint[2, 3]
    a, b, c, x, y, z = a - ox, b - oy, c - oz, x - ox, y - oy, z - oz
    return math.sqrt((y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2)
