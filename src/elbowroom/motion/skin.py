"""A machine's surface as the sweep takes it: samples to look with, triangles to decide."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.geometry.parallel import spread
from elbowroom.machine import Machine
from elbowroom.machine.samples import ROUNDING_M, BodySamples, body_samples
from elbowroom.machine.shape import Shape
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.kernels.triangles import list_patches

_Array = NDArray[Any]


def skin_of(machine: Machine, voxel_size_m: float) -> Skin:
    """The skin of a machine's checked links for voxels of a size; made once per shape and size, then kept.

    Args:
        machine: whose links.
        voxel_size_m: edge of a voxel [m].

    Raises:
        MachineError: as `body_samples`.
    """
    return _skin(machine.shape, body_samples(machine, voxel_size_m))


@kept
def _skin(shape: Shape, samples: BodySamples) -> Skin:
    links = shape.within(samples.bound_m)
    counts = samples.cluster_stop - samples.cluster_start
    triangles = np.concatenate([link.triangles for link in links])
    stops = np.cumsum([0] + [len(link.faces) for link in links])
    rows = np.unique(samples.cluster_link).tolist()
    sizes = np.zeros(len(samples.points), dtype=np.int32)
    spread(lambda row: _list(samples, row, (triangles, stops), sizes, False), rows)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    patches = np.zeros(starts[-1], dtype=np.int32)
    firsts = samples.cluster_start[np.searchsorted(samples.cluster_link, rows)]
    spread(
        lambda pair: _list(samples, pair[0], (triangles, stops), patches[starts[pair[1]] :], True),
        list(zip(rows, firsts, strict=True)),
    )
    return bare_skin(samples, samples.points)._replace(
        cluster_of=np.repeat(np.arange(counts.size, dtype=np.int32), counts),
        triangles=triangles,
        patches=patches,
        patch_start=starts,
        columns=np.ascontiguousarray(samples.points.T),
    )


def bare_skin(samples: BodySamples, points: NDArray[np.float32]) -> Skin:
    """The samples in their clusters, without triangles.

    Args:
        samples: of links.
        points: those of the samples, in any order within each cluster, shape (n, 3), link frame [m].
    """
    none = np.zeros(0, dtype=np.int32)
    of = np.repeat(np.arange(len(samples.cluster_start)), samples.cluster_stop - samples.cluster_start)
    half = np.zeros((len(samples.cluster_start), 3))
    for axis in range(3):  # one at a time, since there are many
        np.maximum.at(half[:, axis], of, np.abs(points[:, axis] - samples.cluster_centre[of, axis]))
    return Skin(
        points=points,
        cluster_of=none,
        start=samples.cluster_start,
        stop=samples.cluster_stop,
        link=samples.cluster_link,
        centre=samples.cluster_centre,
        radius=samples.cluster_radius,
        half=half,
        cover=samples.cover_m,
        off=samples.bound_m,
        triangles=np.zeros((0, 3, 3)),
        patches=none,
        patch_start=np.zeros(0, dtype=np.int64),
        columns=np.zeros((3, 0), dtype=np.float32),
    )


def _list(samples: BodySamples, row: int, of: tuple[_Array, _Array], near: _Array, fill: bool) -> None:
    """Lists the patches of one link: their sizes by sample, or the triangles' numbers, one patch after another.

    Args:
        samples: of all links.
        row: of the link.
        of: the triangles of all links, and where those of each begin.
        near: takes what is listed.
        fill: whether it takes numbers.
    """
    triangles, stops = of
    first, last = np.searchsorted(samples.cluster_link, [row, row + 1])
    reach = samples.cover_m + ROUNDING_M
    list_patches(samples.clusters, reach, first, last, triangles, stops[row : row + 2], near, fill)
