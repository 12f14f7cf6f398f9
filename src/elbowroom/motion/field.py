"""Distances about each link of a machine, on lattices."""

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Link
from elbowroom.machine.kernels.samples import OPEN, SURFACE, flood, mark_surface
from elbowroom.motion.kernels.field import Fields

MOST_CELLS = 500_000
"""A link's lattice has about as many cells at most; so long links are measured more coarsely."""
AROUND = 3
"""So many cells lie about the box that holds a link."""


class _Field(NamedTuple):
    """Distances of cells [m], the least corner of their lattice [m], the edge of a cell [m]."""

    values: NDArray[np.float32]
    lower: NDArray[np.float64]
    edge: float


def fields_of(links: Sequence[Link], rows: Collection[int], finest_m: float) -> Fields:
    """The distances about links of a machine.

    Args:
        links: of the machine.
        rows: of those that are asked for; about all others nothing is known.
        finest_m: edge of a cell, at least [m].
    """
    fields = spread(
        lambda row: _field(links[row], finest_m) if row in rows else _nothing(finest_m), range(len(links))
    )
    sizes = [field.values.size for field in fields]
    return Fields(
        values=np.concatenate([field.values.reshape(-1) for field in fields]),
        start=np.cumsum([0, *sizes[:-1]]),
        shape=np.array([field.values.shape for field in fields], dtype=np.int64),
        lower=np.array([field.lower for field in fields]),
        edge=np.array([field.edge for field in fields]),
    )


@kept
def _field(link: Link, finest_m: float) -> _Field:
    """The distances about one link: to the middles of cells that its surface touches."""
    lower, upper = link.vertices[link.faces].min(axis=(0, 1)), link.vertices[link.faces].max(axis=(0, 1))
    edge = _edge(upper - lower, finest_m)
    lower = lower - AROUND * edge
    shape = np.ceil((upper - lower) / edge).astype(np.int64) + AROUND
    cells = np.zeros(tuple(shape), dtype=np.uint8)
    mark_surface(link.triangles, lower, edge, cells)
    nearest = _nearest(cells)
    flood(cells)
    values = np.empty(cells.shape, dtype=np.float32)
    across = np.indices(cells.shape[1:])
    for i in range(len(values)):  # all at once they would take five times the memory
        steps = np.stack([nearest[0, i] - i, *(nearest[1:, i] - across)]).astype(np.float64)
        away = np.sqrt((steps * steps).sum(axis=0)) * edge
        values[i] = np.where(cells[i] == OPEN, -away, away)
    return _Field(values, lower, edge)


def _nearest(cells: NDArray[np.uint8]) -> NDArray[np.int32]:
    """For each cell the nearest one that the surface touches, shape (3, *cells.shape)."""
    from scipy import ndimage  # slow to load, and a bare room needs none of it

    found: NDArray[np.int32] = ndimage.distance_transform_edt(
        cells != SURFACE, return_distances=False, return_indices=True
    )
    return found


def _nothing(edge: float) -> _Field:
    """Of a link that is not asked for."""
    return _Field(np.full((2, 2, 2), np.inf, dtype=np.float32), np.zeros(3), edge)


def _edge(extent: NDArray[np.float64], finest_m: float) -> float:
    """The edge of a cell with which a box has `MOST_CELLS` [m]."""
    coarse = max(finest_m, float(extent.max()) / MOST_CELLS)
    while np.prod(np.ceil(extent / coarse) + 2 * AROUND) > MOST_CELLS:
        coarse *= 1.1
    return coarse
