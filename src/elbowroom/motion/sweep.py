"""How fast the machine's points move along a way, and where they first meet a block."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import bits
from elbowroom.machine import Machine
from elbowroom.machine.kernels.body import FIXED, SLIDES
from elbowroom.motion.beside import first_stop_blocked
from elbowroom.motion.block import Block
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.mover import Skin, bound_speeds
from elbowroom.motion.kernels.shared import WORDS, Shared
from elbowroom.motion.kernels.sweep import Asked, first_block, to_ask
from elbowroom.motion.kernels.volume import Volume, block, gather_corners
from elbowroom.reconstruct.free_space import FreeSpace

FINEST_STEP_IN_VOXELS = 1 / 16
"""The first block is found to within a travel in which no point moves farther than this [voxel edges]."""
SAMPLE_HALVINGS = 3
"""Single samples are looked at in the last so many halvings, clusters before: from half a voxel on, where the balls
about samples are no larger than a voxel and one look at a corner settles most of them."""
MOST_HALVINGS = 40
"""No interval is cut more often: a travel of 10^12 finest steps."""


def volume_of(space: FreeSpace) -> Volume:
    """The blocked voxels of a space as the kernels take them."""
    words = np.empty_like(space.free_words)
    cubes = np.empty(words.size // 64, dtype=np.bool_)
    lattice = bits.lattice(space.grid)
    block(space.free_words, lattice, words, cubes)
    corners = np.empty_like(words)
    gather_corners(words, lattice, np.empty_like(words), corners)
    return Volume(
        lattice, words, corners, cubes, space.surface_words, space.blind_words, space.disputed_words, _none()
    )


def marked(volume: Volume) -> Volume:
    """A volume whose words were changed, with what is known of its corners and cubes.

    Args:
        volume: of which only the words hold.
    """
    corners = np.empty_like(volume.words)
    gather_corners(volume.words, volume.lattice, np.empty_like(volume.words), corners)
    return volume._replace(corners=corners, cubes=(volume.words.reshape(-1, 64) != 0).any(axis=1))


def _none() -> Shared:
    """No voxel that a link reaches into at the start."""
    return Shared(
        np.zeros(0, dtype=np.int64),
        np.zeros((0, 0), dtype=np.bool_),
        np.zeros((0, WORDS), dtype=np.uint64),
        True,
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
    asked: Asked | None = None,
) -> Block | None:
    """The first block that the swept body meets, or None on the whole way.

    Args:
        machine, skin, way: what moves, and where to.
        speeds: of `cluster_speeds`; 0 for those that are not asked.
        volume: of `volume_of`.
        asked: of the block in a volume of which this one is a part: the sweep goes on from there.
    """
    if way.length == 0 or not (speeds > 0).any():
        return None
    if way.stops is not None:
        return first_stop_blocked(machine, skin, speeds, way, volume)
    halvings = halvings_of(way, speeds, volume)
    if asked is None:
        asked = to_ask(skin, speeds, max(0, halvings - SAMPLE_HALVINGS), halvings)
    index, kind, cluster, place, met = first_block(
        machine.tree,
        machine.world_from_base,
        skin,
        way.course,
        way.length,
        speeds,
        volume,
        asked,
    )
    if index < 0:
        return None
    return Block(index * way.length / 2.0**halvings, kind, cluster, place, met, asked)


def halvings_of(way: Way, speeds: NDArray[np.float64], volume: Volume) -> int:
    """How often a way is cut in half until no point moves farther than the finest step in a part.

    Args:
        way, speeds, volume: as of `find_block`.
    """
    finest = volume.lattice.edge * FINEST_STEP_IN_VOXELS
    return int(np.clip(np.ceil(np.log2(way.length * speeds.max() / finest)), 0, MOST_HALVINGS))


def _link_lengths(machine: Machine, way: Way) -> NDArray[np.float64]:
    """The farthest that each link's frame can be from its parent's on the way [m], shape (n_links,)."""
    tree = machine.tree
    lengths = np.linalg.norm(tree.parent_from_joint[:, :3, 3], axis=1)
    slides = tree.kind == SLIDES
    positions = way.course.positions[:, tree.column[slides]] * tree.multiplier[slides] + tree.offset[slides]
    lengths[slides] += np.abs(positions).max(axis=0)
    return lengths
