"""How fast the machine's points move along a way, and where they first meet a block."""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.machine import Machine
from elbowroom.machine._kernels import FIXED, SLIDES
from elbowroom.machine.samples import BodySamples, body_samples
from elbowroom.motion._kernels import Skin, Volume, block, bound_speeds, first_block
from elbowroom.motion.course import Way

FINEST_STEP_IN_VOXELS = 1 / 16
"""The first block is found to within a travel in which no point moves farther than this [voxel edges]."""
SAMPLE_HALVINGS = 5
"""Single samples are looked at in the last so many halvings (from two voxels on), clusters before."""
MOST_HALVINGS = 40
"""No interval is cut more often: a travel of 10^12 finest steps."""


_SKINS: WeakKeyDictionary[Machine, dict[float, Skin]] = WeakKeyDictionary()


class Block(NamedTuple):
    """The first interval in which samples meet a block: its start, half its length [travel], the samples."""

    travel: float
    half: float
    samples: NDArray[np.int32]


def blocked_volume(free_words: bits.Words, grid: VoxelGrid) -> Volume:
    """The blocked voxels of a grid, with a mark for each cube that holds one.

    Args:
        free_words: plane of the free voxels.
        grid: its grid.
    """
    words = np.empty_like(free_words)
    cubes = np.empty(free_words.size // 64, dtype=np.bool_)
    block(free_words, bits.lattice(grid), words, cubes)
    return Volume(words, cubes)


def skin_of(machine: Machine, voxel_size_m: float) -> Skin:
    """Surface samples of a machine's checked links as the kernels take them; made once and kept."""
    kept = _SKINS.setdefault(machine, {})
    if voxel_size_m not in kept:
        kept[voxel_size_m] = _skin(body_samples(machine, voxel_size_m))
    return kept[voxel_size_m]


def _skin(samples: BodySamples) -> Skin:
    counts = samples.cluster_stop - samples.cluster_start
    return Skin(
        samples.points,
        np.repeat(np.arange(counts.size, dtype=np.int32), counts),
        samples.cluster_start,
        samples.cluster_stop,
        samples.cluster_link,
        samples.cluster_centre,
        samples.cluster_radius,
        samples.cover_m,
    )


def cluster_speeds(
    machine: Machine, skin: Skin, world_from_link: NDArray[np.float64], way: Way
) -> NDArray[np.float64]:
    """The most that any point of a cluster moves per unit of travel, anywhere on the way.

    Each joint above the cluster's link adds its own rate: times one if it slides, times the distance from its
    axis to the farthest point if it turns. Below the last joint that moves, that distance never changes and
    is measured at the start; for joints farther up it is bounded by the lengths of the chain from there to
    the cluster.

    Args:
        machine: the machine.
        skin: its surface samples.
        world_from_link: at the start of the way, shape (n_links, 4, 4).
        way: where the motion leads.

    Returns:
        [m per unit of travel], shape (n_clusters,).
    """
    tree = machine.tree
    rates = np.append(way.rates, 0.0)[tree.column] * np.abs(tree.multiplier)
    rates[tree.kind == FIXED] = 0.0
    return bound_speeds(tree, rates, _link_lengths(machine, way), world_from_link, skin)


def find_block(
    machine: Machine,
    skin: Skin,
    speeds: NDArray[np.float64],
    way: Way,
    volume: Volume,
    grid: VoxelGrid,
) -> Block | None:
    """The first block that the swept body meets, or None on the whole way.

    Args:
        machine, skin, way: what moves, and where to.
        speeds: of `cluster_speeds`.
        volume: of `blocked_volume`.
        grid: the volume's grid.
    """
    moving = np.flatnonzero(speeds > 0).astype(np.int32)
    if way.length == 0 or moving.size == 0:
        return None
    finest = grid.voxel_size_m * FINEST_STEP_IN_VOXELS
    halvings = int(np.clip(np.ceil(np.log2(way.length * speeds.max() / finest)), 0, MOST_HALVINGS))
    index, samples = first_block(
        machine.tree,
        machine.world_from_base,
        way.course,
        way.length,
        skin,
        speeds,
        moving,
        volume,
        bits.lattice(grid),
        max(0, halvings - SAMPLE_HALVINGS),
        halvings,
    )
    if index < 0:
        return None
    interval = way.length / 2.0**halvings
    return Block(index * interval, interval / 2, samples)


def _link_lengths(machine: Machine, way: Way) -> NDArray[np.float64]:
    """The farthest that each link's frame can be from its parent's on the way [m], shape (n_links,)."""
    tree = machine.tree
    lengths = np.linalg.norm(tree.parent_from_joint[:, :3, 3], axis=1)
    slides = tree.kind == SLIDES
    positions = way.course.positions[:, tree.column[slides]] * tree.multiplier[slides] + tree.offset[slides]
    lengths[slides] += np.abs(positions).max(axis=0)
    return lengths
