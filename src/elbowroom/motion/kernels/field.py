"""How far points are from a link: distances on a lattice about each link, below zero within it."""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.motion.kernels.volume import cell_of, gap


class Fields(NamedTuple):
    """Distances from the surface of each link, of the cells of a lattice about it [m].

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
    """What a field of cells of this edge may be wrong by [m]: half a cell's diagonal where its distances were
    measured, to the middles of cells, and as much within a cell, as no distance changes faster than its place."""
    return 1.7321 * edge


@njit
def at_least(fields, link, x, y, z):
    """No more than the distance of a point, in a link's frame, from its surface; below zero within it [m]."""
    edge, lower = fields.edge[link], fields.lower[link]
    nx, ny, nz = fields.shape[link, 0], fields.shape[link, 1], fields.shape[link, 2]
    u, v, w = (x - lower[0]) / edge, (y - lower[1]) / edge, (z - lower[2]) / edge
    cell = (cell_of(u, nx) * ny + cell_of(v, ny)) * nz + cell_of(w, nz)
    value = fields.values[fields.start[link] + cell] - slack_of(edge)
    a, b, c = gap(u, 0.0, float(nx)), gap(v, 0.0, float(ny)), gap(w, 0.0, float(nz))
    if a + b + c == 0.0:
        return value
    # the link lies within the lattice
    beyond = math.sqrt(a * a + b * b + c * c) * edge
    return max(beyond, value - beyond)
