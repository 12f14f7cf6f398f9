"""A machine's surface as the sweep takes it: samples to look with, triangles to decide."""

import numpy as np

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.machine.samples import ROUNDING_M, BodySamples, body_samples
from elbowroom.machine.shape import Shape
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.kernels.triangles import list_patches


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
    sizes = np.zeros(len(samples.points), dtype=np.int32)
    _list(samples, triangles, stops, sizes, False)
    patches = np.zeros(sizes.sum(), dtype=np.int32)
    _list(samples, triangles, stops, patches, True)
    return Skin(
        points=samples.points,
        cluster_of=np.repeat(np.arange(counts.size, dtype=np.int32), counts),
        start=samples.cluster_start,
        stop=samples.cluster_stop,
        link=samples.cluster_link,
        centre=samples.cluster_centre,
        radius=samples.cluster_radius,
        cover=samples.cover_m,
        off=samples.bound_m,
        triangles=triangles,
        patches=patches,
        patch_start=np.concatenate([[0], np.cumsum(sizes)]),
    )


def _list(
    samples: BodySamples, triangles: np.ndarray, stops: np.ndarray, near: np.ndarray, fill: bool
) -> None:
    """Lists the patches link by link; `near` gets their sizes by sample, or the triangles' numbers."""
    written = 0
    for link in np.unique(samples.cluster_link):
        first, last = np.searchsorted(samples.cluster_link, [link, link + 1])
        written += list_patches(
            samples.clusters,
            samples.cover_m + ROUNDING_M,
            first,
            last,
            triangles,
            stops[link : link + 2],
            near[written:] if fill else near,
            fill,
        )
