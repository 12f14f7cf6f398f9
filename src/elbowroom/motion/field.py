"""Distances about each link of a machine, on lattices."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.parallel import spread
from elbowroom.machine import Link, Machine
from elbowroom.machine.kernels.samples import mark_surface
from elbowroom.motion.kernels.field import Fields

MOST_CELLS = 500_000
"""A link's lattice has about as many cells at most; so long links are measured more coarsely."""
AROUND = 3
"""So many cells lie about the box that holds a link."""


def fields_of(machine: Machine, rows: Sequence[int], finest_m: float) -> Fields:
    """The distances about links of a machine.

    Args:
        machine: whose links.
        rows: of those that are asked for; about all others nothing is known.
        finest_m: edge of a cell, at least [m].
    """
    parts = spread(lambda row: _field(machine.links[row], finest_m) if row in rows else _nothing(finest_m), range(len(machine.links)))
    sizes = [values.size for values, _, _ in parts]
    return Fields(
        values=np.concatenate([values.reshape(-1) for values, _, _ in parts]),
        start=np.cumsum([0, *sizes[:-1]]),
        shape=np.array([values.shape for values, _, _ in parts], dtype=np.int64),
        lower=np.array([lower for _, lower, _ in parts]),
        edge=np.array([edge for _, _, edge in parts]),
    )


def _field(link: Link, finest_m: float) -> tuple[NDArray[np.float32], NDArray[np.float64], float]:
    """Distances of cells, the least corner of their lattice, and the edge of a cell [m].

    They are those to the middles of cells that the surface touches.
    """
    from scipy import ndimage  # slow to load, and a bare room needs none of it

    lower, upper = link.triangles.min(axis=(0, 1)), link.triangles.max(axis=(0, 1))
    edge = _edge(upper - lower, finest_m)
    lower = lower - AROUND * edge
    shape = np.ceil((upper - lower) / edge).astype(np.int64) + AROUND
    surface = np.zeros(tuple(shape), dtype=np.bool_)
    mark_surface(link.triangles, lower, edge, surface)
    parts, _ = ndimage.label(~surface)
    within = (parts != parts[0, 0, 0]) & ~surface
    away = ndimage.distance_transform_edt(~surface) * edge
    return np.where(within, -away, away).astype(np.float32), lower, edge


def _nothing(edge: float) -> tuple[NDArray[np.float32], NDArray[np.float64], float]:
    """Of a link that is not asked for."""
    return np.full((2, 2, 2), np.inf, dtype=np.float32), np.zeros(3), edge


def _edge(extent: NDArray[np.float64], finest_m: float) -> float:
    """The edge of a cell with which a box has `MOST_CELLS` [m]."""
    coarse = max(finest_m, float(extent.max()) / MOST_CELLS)
    while np.prod(np.ceil(extent / coarse) + 2 * AROUND) > MOST_CELLS:
        coarse *= 1.1
    return coarse
