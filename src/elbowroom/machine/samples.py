"""Points that stand for the body of a machine: on its surface, and inside it."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

import llvmlite.binding
import numba
import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.files.kept_arrays import Arrays, kept_arrays
from elbowroom.geometry.kept import kept
from elbowroom.geometry.parallel import spread
from elbowroom.machine.kernels import samples as kernels
from elbowroom.machine.kernels.body import Clusters
from elbowroom.machine.link import Link
from elbowroom.machine.machine import Machine

COVER_IN_VOXELS = 0.25
"""Covering radius of the surface samples over the edge of a voxel."""
CLUSTER_SIZE = 64
"""Surface points in a cluster, at most."""
ROUNDING_M = 2e-6
"""What points lose by being float32; the covering radius is kept with this to spare [m]."""
MAX_CELLS = 400_000_000
"""A link whose bounding box has more fine cells than this is refused: the voxels are too small for it."""


@dataclass(frozen=True, slots=True, eq=False)
class BodySamples:
    """Sample points of links, each in its link's frame; move them with `world_from_link_array`.

    Every point of a link's surface lies within `cover_m` of a surface sample of that link, and every surface
    sample lies on the surface. A cube of edge `voxel_size_m` wholly inside the solid holds an interior
    sample, however it is turned; an interior sample lies in the solid or within `cover_m` of its surface. So
    the solid touches a voxel only if the voxel lies within `cover_m` of a surface sample or holds an interior
    one.

    The arrays of surface points are sorted by link, and within a link by cluster: cluster c is the points
    `cluster_start[c]` to `cluster_stop[c]` (exclusive), at most 64 that lie close together.

    Args:
        voxel_size_m: edge of the voxels that the samples are made for [m].
        cover_m: a quarter of it [m].
        points: surface samples, shape (n, 3), float32, link frame [m].
        point_link: for each, the row in `machine.links`, shape (n,), int32.
        cluster_link: for each cluster, the row in `machine.links`, shape (k,), int32.
        cluster_start, cluster_stop: its points, shape (k,), int64.
        cluster_centre: middle of its bounding sphere, shape (k, 3), float64, link frame [m].
        cluster_radius: radius of that sphere about the centre, shape (k,), float64 [m]; the samples lie in
            it, the surface that they stand for within `cover_m` of it.
        interior: interior samples, shape (m, 3), float32, link frame [m].
        interior_link: for each, the row in `machine.links`, shape (m,), int32.
    """

    voxel_size_m: float
    cover_m: float
    points: NDArray[np.float32]
    point_link: NDArray[np.int32]
    cluster_link: NDArray[np.int32]
    cluster_start: NDArray[np.int64]
    cluster_stop: NDArray[np.int64]
    cluster_centre: NDArray[np.float64]
    cluster_radius: NDArray[np.float64]
    interior: NDArray[np.float32]
    interior_link: NDArray[np.int32]

    @property
    def clusters(self) -> Clusters:
        """The surface samples as kernels take them."""
        return Clusters(
            self.points,
            self.cluster_start,
            self.cluster_stop,
            self.cluster_link,
            self.cluster_centre,
            self.cluster_radius,
        )


class _LinkSamples(NamedTuple):
    """The samples of one link: points in cluster order, where clusters stop (k + 1), interior points."""

    points: NDArray[np.float32]
    stops: NDArray[np.int64]
    interior: NDArray[np.float32]


def body_samples(machine: Machine, voxel_size_m: float, *, unchecked: bool = False) -> BodySamples:
    """The samples of a machine's checked links for a size of voxels; made once, then kept, on disk as well.

    Args:
        machine: whose links.
        voxel_size_m: edge of a voxel [m].
        unchecked: whether to take the unchecked links as well.

    Raises:
        MachineError: the size is not above zero, or so small that a link has too many cells.
    """
    if not (np.isfinite(voxel_size_m) and voxel_size_m > 0):
        raise MachineError(f"body samples: voxel_size_m is {voxel_size_m}, must be above 0 [m]")
    return _samples(machine, float(voxel_size_m), unchecked and len(machine.unchecked_links) > 0)


@kept
def _samples(machine: Machine, voxel_size_m: float, unchecked: bool) -> BodySamples:
    names = machine.checked_links
    rows = [
        row
        for row, link in enumerate(machine.links)
        if link.has_geometry and (unchecked or link.name in names)
    ]
    cover_m = COVER_IN_VOXELS * voxel_size_m
    name = _name_of([machine.links[row] for row in rows], rows, voxel_size_m)
    arrays = kept_arrays(name, lambda: _arrays(machine, rows, voxel_size_m, cover_m))
    for array in arrays.values():
        array.setflags(write=False)
    return BodySamples(voxel_size_m, cover_m, **arrays)  # type: ignore[arg-type]


def _name_of(links: Sequence[Link], rows: Sequence[int], voxel_size_m: float) -> str:
    """Of the arrays of some links, in these rows: all that they depend on, their making included."""
    parts = [f"{voxel_size_m!r} {rows}".encode(), *(link.triangles.tobytes() for link in links), _making()]
    digest = hashlib.sha256()
    for part in parts:
        digest.update(len(part).to_bytes(8, "little") + part)
    return f"body-{digest.hexdigest()}"


@cache
def _making() -> bytes:
    """What samples are made by: this file, its kernels, and what compiles and runs them."""
    cpu, plain = llvmlite.binding.get_host_cpu_name(), numba.config.DISABLE_JIT  # type: ignore[attr-defined]
    made_by = f"{numba.__version__} {np.__version__} {cpu} {plain}"
    return b"".join([made_by.encode(), *(Path(file).read_bytes() for file in (__file__, kernels.__file__))])


def _arrays(machine: Machine, rows: Sequence[int], voxel_size_m: float, cover_m: float) -> Arrays:
    """The arrays of `BodySamples`.

    Args:
        machine, voxel_size_m: as of `body_samples`.
        rows: of the links.
        cover_m: covering radius [m].
    """
    parts = spread(lambda row: _sample_link(machine.links[row], voxel_size_m, cover_m), rows)
    firsts = np.cumsum([0] + [len(part.points) for part in parts])
    starts = np.concatenate([first + part.stops[:-1] for first, part in zip(firsts[:-1], parts, strict=True)])
    stops = np.concatenate([first + part.stops[1:] for first, part in zip(firsts[:-1], parts, strict=True)])
    points = np.concatenate([part.points for part in parts])
    centre, radius = _spheres(points, starts, stops)
    return {
        "points": points,
        "point_link": np.repeat(np.asarray(rows, dtype=np.int32), [len(part.points) for part in parts]),
        "cluster_link": np.repeat(np.asarray(rows, dtype=np.int32), [len(part.stops) - 1 for part in parts]),
        "cluster_start": starts,
        "cluster_stop": stops,
        "cluster_centre": centre,
        "cluster_radius": radius,
        "interior": np.concatenate([part.interior for part in parts]),
        "interior_link": np.repeat(np.asarray(rows, dtype=np.int32), [len(part.interior) for part in parts]),
    }


def _sample_link(link: Link, voxel_size_m: float, cover_m: float) -> _LinkSamples:
    points = surface_points(link.triangles, cover_m - ROUNDING_M)
    order = np.empty(len(points), dtype=np.int64)
    stops = np.empty(len(points) + 1, dtype=np.int64)
    count = kernels.cluster(points, CLUSTER_SIZE, order, stops)
    return _LinkSamples(
        points[order].astype(np.float32),
        stops[: count + 1],
        interior_points(link, voxel_size_m).astype(np.float32),
    )


def surface_points(triangles: NDArray[np.float64], cover_m: float) -> NDArray[np.float64]:
    """Few points of triangles such that all of them lies within `cover_m` of a point.

    The triangles are cut into pieces finer than the covering radius; then those points are kept that cover
    most of what is left. On flat parts that ends within half again of the best possible, a square lattice.

    Args:
        triangles: shape (m, 3, 3) [m].
        cover_m: covering radius [m].

    Returns:
        shape (n, 3) [m].
    """
    # 3 x 3 pieces of this pitch just fit within reach of the middle one
    pitch = 0.47 * cover_m
    count = kernels.tile_triangles(triangles, pitch, np.empty((0, 3)), np.empty(0), False)
    points, reach = np.empty((count, 3)), np.empty(count)
    kernels.tile_triangles(triangles, pitch, points, reach, True)
    edge = 0.67 * cover_m
    index = np.floor((points - points.min(axis=0)) / edge).astype(np.int64) + 1
    _, size_y, size_z = index.max(axis=0) + 2
    number = (index[:, 0] * size_y + index[:, 1]) * size_z + index[:, 2]
    order = np.argsort(number, kind="stable")
    points, number = points[order], number[order]
    is_first = np.append(True, number[1:] != number[:-1])
    first = np.append(np.flatnonzero(is_first), count)
    runs = kernels.neighbour_runs(number[is_first], size_y * size_z, size_z, first)
    slack = cover_m - reach[order]
    return points[kernels.thin_out(points, slack * slack, np.cumsum(is_first) - 1, runs)]


def interior_points(link: Link, voxel_size_m: float) -> NDArray[np.float64]:
    """A lattice of points in the solid that a link encloses; gaps narrower than v / 3.5 count as closed.

    The surface is marked in a lattice of cells of half the points' pitch; what cannot be reached from outside
    without crossing a marked cell is inside. Points in marked cells are kept: they lie within a quarter voxel
    of the surface.

    Args:
        link: a link with geometry.
        voxel_size_m: edge v; a cube of that edge wholly inside holds a point.

    Returns:
        shape (m, 3), link frame [m].

    Raises:
        MachineError: the link's bounding box has more than `MAX_CELLS` such cells.
    """
    from scipy import ndimage  # slow to load, and a bare room needs none of it

    edge = 0.9999 * voxel_size_m / (2 * np.sqrt(3))
    lower = link.triangles.min(axis=(0, 1)) - 1.5 * edge
    counts = np.floor((link.triangles.max(axis=(0, 1)) - lower) / edge).astype(np.int64) + 2
    if np.prod(counts.astype(float)) > MAX_CELLS:
        raise MachineError(
            f"link {link.name}: {counts.tolist()} cells of {edge:.2g} m for voxels of {voxel_size_m:g} m are "
            f"more than {MAX_CELLS:,}; use larger voxels"
        )
    surface = np.zeros(tuple(counts), dtype=np.bool_)
    kernels.mark_surface(link.triangles, lower, edge, surface)
    outside, _ = ndimage.label(~surface)
    inside = np.argwhere(outside[::2, ::2, ::2] != outside[0, 0, 0])
    return lower + (2 * inside + 0.5) * edge


def _spheres(
    points: NDArray[np.float32], starts: NDArray[np.int64], stops: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Middle of the bounding box of each cluster, and the farthest of its points from there."""
    given = points.astype(np.float64)
    centre = (np.minimum.reduceat(given, starts) + np.maximum.reduceat(given, starts)) / 2
    away = np.linalg.norm(given - np.repeat(centre, stops - starts, axis=0), axis=1)
    return centre, np.maximum.reduceat(away, starts)
