"""How far points are from a link: distances on a lattice about each link, below zero within it."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.motion.kernels.volume import gap


class Fields(NamedTuple):
    """Distances from the surface of each link, at the centres of the cells of a lattice about it [m].

    Fields:
        values: of all links, one after another, float32, in index order x, y, z; below zero within a link.
        start: of each link in `values`, (links,).
        shape: of each link's lattice, (links, 3).
        lower: its least corner in the link's frame, (links, 3) [m].
        edge: of its cells, (links,) [m].
    """

    values: np.ndarray
    start: np.ndarray
    shape: np.ndarray
    lower: np.ndarray
    edge: np.ndarray


@njit(inline="always")
def slack_of(edge):
    """What a field of cells of this edge may be wrong by [m]: by half a cell's diagonal where its distances were measured
    from the middles of cells, and as much between the middles of cells, as no distance changes faster than its place."""
    return 1.7321 * edge


@njit
def at_least(fields, link, x, y, z):
    """No more than the distance of a point, in a link's frame, from its surface; below zero within it [m]."""
    edge, shape, lower = fields.edge[link], fields.shape[link], fields.lower[link]
    u, v, w = (x - lower[0]) / edge - 0.5, (y - lower[1]) / edge - 0.5, (z - lower[2]) / edge - 0.5
    a, b, c = gap(u, 0.0, shape[0] - 1.0), gap(v, 0.0, shape[1] - 1.0), gap(w, 0.0, shape[2] - 1.0)
    beyond = math.sqrt(a * a + b * b + c * c) * edge
    value = _between(fields, link, u, v, w) - slack_of(edge)
    # the link lies within the lattice, and no distance changes faster than its place
    return value if beyond == 0.0 else max(beyond, value - beyond)


@njit(inline="always")
def _first_of(coordinate, count):
    """The first of the two cells that a coordinate lies between, and its share of the second."""
    held = min(max(coordinate, 0.0), count - 1.0)
    first = min(int(held), count - 2)
    return first, held - first


@njit
def _between(fields, link, u, v, w):
    """The field at a place counted in cells, between the eight middles of cells about it."""
    shape, values = fields.shape[link], fields.values
    i, a = _first_of(u, shape[0])
    j, b = _first_of(v, shape[1])
    k, c = _first_of(w, shape[2])
    ny, nz = shape[1], shape[2]
    one = fields.start[link] + (i * ny + j) * nz + k
    two, three = one + nz, one + ny * nz
    four = three + nz
    near = (1.0 - b) * ((1.0 - c) * values[one] + c * values[one + 1]) + b * (
        (1.0 - c) * values[two] + c * values[two + 1]
    )
    far = (1.0 - b) * ((1.0 - c) * values[three] + c * values[three + 1]) + b * (
        (1.0 - c) * values[four] + c * values[four + 1]
    )
    return (1.0 - a) * near + a * far
