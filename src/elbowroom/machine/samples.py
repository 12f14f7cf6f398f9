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
from elbowroom.machine import simplify
from elbowroom.machine.kernels import samples as kernels
from elbowroom.machine.kernels import simplify as simplify_kernels
from elbowroom.machine.kernels.body import Clusters
from elbowroom.machine.link import Link
from elbowroom.machine.machine import Machine
from elbowroom.machine.shape import Shape

COVER_IN_VOXELS = 0.25
"""Covering radius of the surface samples over the edge of a voxel."""
BOUND_IN_COVERS = 0.125
"""Of a fine machine samples may lie off the surface by this share of the covering radius."""
CLUSTER_SIZE = 64
"""Surface points in a cluster, at most."""
ROUNDING_M = 2e-6
"""What points lose by being float32; the covering radius is kept with this to spare [m]."""
MAX_CELLS = 400_000_000
"""A link whose bounding box has more fine cells than this is refused: the voxels are too small for it."""
MAX_PIECES = 20_000_000
"""A link whose surface is cut into more pieces than this as well: seconds of work, and a gigabyte."""
PITCH_IN_COVERS = 0.47
"""Side of a piece over the covering radius: 3 x 3 pieces just fit within reach of the middle one."""
MADE_BY = (__file__, kernels.__file__, simplify.__file__, simplify_kernels.__file__)
"""What samples are made by: files of this package."""


@dataclass(frozen=True, slots=True, eq=False)
class BodySamples:
    """Sample points of links, each in its link's frame; move them with `world_from_link_array`.

    Every point of a link's surface lies within `cover_m` of a surface sample of that link, and every surface
    sample lies on the surface; of a fine machine (`Shape`) within `bound_m` of it, and then every point of the surface
    within `cover_m` less `bound_m` of a sample. A cube of edge `voxel_size_m` wholly inside the solid holds an interior
    sample, however it is turned; an interior sample lies in the solid or within `cover_m` of its surface. So
    the solid touches a voxel only if the voxel lies within `cover_m` of a surface sample or holds an interior
    one.

    The arrays of surface points are sorted by link, and within a link by cluster: cluster c is the points
    `cluster_start[c]` to `cluster_stop[c]` (exclusive), at most 64 that lie close together.

    Args:
        voxel_size_m: edge of the voxels that the samples are made for [m].
        cover_m: a quarter of it [m].
        bound_m: how far samples may lie off the surface, an eighth of `cover_m` at most [m].
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
    bound_m: float
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


class _Sizes(NamedTuple):
    """For which voxels, how close, and how far off the surface samples are made [m], as of `BodySamples`."""

    voxel_size_m: float
    cover_m: float
    bound_m: float


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
    names = machine.checked_links
    rows = tuple(
        row
        for row, link in enumerate(machine.links)
        if link.has_geometry and (unchecked or link.name in names)
    )
    return _samples(machine.shape, float(voxel_size_m), rows)


@kept
def _samples(shape: Shape, voxel_size_m: float, rows: tuple[int, ...]) -> BodySamples:
    cover_m = COVER_IN_VOXELS * voxel_size_m
    for row in rows:
        _require_few(shape.links[row], shape.areas[row], voxel_size_m)
    name = _name_of(shape, rows, voxel_size_m)
    bound_m = shape.bound(BOUND_IN_COVERS * cover_m)
    sizes = _Sizes(voxel_size_m, cover_m, bound_m)
    arrays = kept_arrays(name, lambda: _arrays(shape.within(bound_m), rows, sizes))
    for array in arrays.values():
        array.setflags(write=False)
    return BodySamples(voxel_size_m, cover_m, bound_m, **arrays)  # type: ignore[arg-type]


def _name_of(shape: Shape, rows: Sequence[int], voxel_size_m: float) -> str:
    """Of the arrays of the links in some rows: all that they depend on, their making included."""
    digest = hashlib.sha256()
    for part in (f"{voxel_size_m!r} {rows}".encode(), shape.digest, _making()):
        digest.update(len(part).to_bytes(8, "little") + part)
    return f"body-{digest.hexdigest()}"


@cache
def _making() -> bytes:
    """What samples are made by: this file, its kernels, and what compiles and runs them."""
    cpu, plain = llvmlite.binding.get_host_cpu_name(), numba.config.DISABLE_JIT  # type: ignore[attr-defined]
    made_by = f"{numba.__version__} {np.__version__} {cpu} {plain}"
    return b"".join([made_by.encode(), *(Path(file).read_bytes() for file in MADE_BY)])


def _arrays(links: Sequence[Link], rows: Sequence[int], sizes: _Sizes) -> Arrays:
    """The arrays of `BodySamples`.

    Args:
        links: of the machine, fine or coarser.
        rows: of those that are sampled.
        sizes: for which voxels, how close, how coarse.
    """
    parts = spread(lambda row: _sample_link(links[row], sizes), rows)
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


def _sample_link(link: Link, sizes: _Sizes) -> _LinkSamples:
    points = surface_points(link.triangles, sizes.cover_m - ROUNDING_M - 2 * sizes.bound_m)
    order = np.empty(len(points), dtype=np.int64)
    stops = np.empty(len(points) + 1, dtype=np.int64)
    count = kernels.cluster(points, CLUSTER_SIZE, order, stops)
    return _LinkSamples(
        points[order].astype(np.float32),
        stops[: count + 1],
        # what is farther inside than the surface may be off is inside of the fine link as well
        interior_points(link, sizes.voxel_size_m - 4 * sizes.bound_m).astype(np.float32),
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
    pitch = PITCH_IN_COVERS * cover_m
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
    edge, lower, counts = _lattice(link, voxel_size_m)
    if np.prod(counts.astype(float)) > MAX_CELLS:
        raise MachineError(_too_large(link, voxel_size_m))
    cells = np.zeros(tuple(counts), dtype=np.uint8)
    kernels.mark_surface(link.triangles, lower, edge, cells)
    kernels.flood(cells)
    inside = np.argwhere(cells[::2, ::2, ::2] != kernels.OUTSIDE)
    return lower + (2 * inside + 0.5) * edge


def _lattice(link: Link, voxel_size_m: float) -> tuple[float, NDArray[np.float64], NDArray[np.int64]]:
    """Edge of the cells in which a link's inside is found, their least corner, how many there are along each axis."""
    edge = 0.9999 * voxel_size_m / (2 * np.sqrt(3))
    used = np.zeros(len(link.vertices), dtype=np.bool_)
    used[link.faces] = True
    corners = link.vertices[used]
    lower = corners.min(axis=0) - 1.5 * edge
    counts = np.floor((corners.max(axis=0) - lower) / edge).astype(np.int64) + 2
    return edge, lower, counts


def _require_few(link: Link, area: float, voxel_size_m: float) -> None:
    """Refuses a link for which too much memory would be taken, before any is.

    Args:
        link: with geometry.
        area: of its surface [m^2].
        voxel_size_m: edge of a voxel [m].

    Raises:
        MachineError: its bounding box has more than `MAX_CELLS` cells, or its surface more than `MAX_PIECES` pieces.
    """
    pieces = area / (PITCH_IN_COVERS * COVER_IN_VOXELS * voxel_size_m) ** 2
    cells = np.prod(_lattice(link, voxel_size_m)[2].astype(float))
    if not (pieces <= MAX_PIECES and cells <= MAX_CELLS):
        raise MachineError(_too_large(link, voxel_size_m))


def _too_large(link: Link, voxel_size_m: float) -> str:
    size = " x ".join(f"{extent:.3g}" for extent in np.ptp(link.vertices, axis=0))
    return (
        f"link {link.name}: {size} m is too large for voxels of {voxel_size_m:g} m: use larger voxels, or if its "
        'mesh is in millimetres, scale="0.001 0.001 0.001" in the URDF, of a part mesh_scale: 0.001'
    )


def _spheres(
    points: NDArray[np.float32], starts: NDArray[np.int64], stops: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Middle of the bounding box of each cluster, and the farthest of its points from there."""
    given = points.astype(np.float64)
    centre = (np.minimum.reduceat(given, starts) + np.maximum.reduceat(given, starts)) / 2
    away = np.linalg.norm(given - np.repeat(centre, stops - starts, axis=0), axis=1)
    return centre, np.maximum.reduceat(away, starts)
