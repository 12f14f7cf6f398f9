"""Points that stand for the machine's body: on its surface for touching and sweeping, inside for what it fills."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.machine import _kernels_samples as kernels
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
    """Sample points of a machine's links, each in the frame of its link; move them with `world_from_link_array`.

    Every point of a link's surface lies within `cover_m` of a surface sample of that link, and every surface sample
    lies on the surface. A cube of edge `voxel_size_m` wholly inside the solid holds an interior sample, however it is
    turned; an interior sample lies in the solid or within `cover_m` of its surface. So the solid touches a voxel only
    if the voxel lies within `cover_m` of a surface sample or holds an interior one.

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
        cluster_radius: radius of that sphere about the centre, shape (k,), float64 [m]; the samples lie in it, the
            surface that they stand for within `cover_m` of it.
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


def body_samples(machine: Machine, voxel_size_m: float, *, unchecked: bool = False) -> BodySamples:
    """The samples of a machine's checked links for voxels of a size; made once and kept.

    Args:
        machine: whose links.
        voxel_size_m: edge of a voxel [m].
        unchecked: take the unchecked links as well.
    """
    raise NotImplementedError
