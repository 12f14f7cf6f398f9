"""The space that links move in: the same for all but those that may touch what the machine stands on."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import VoxelGrid, bits
from elbowroom.geometry.bits import Words
from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.machine.stand import ROUNDING_IN_VOXELS, Stand
from elbowroom.motion.kernels.volume import Volume
from elbowroom.motion.sweep import volume_of
from elbowroom.reconstruct.free_space import FreeSpace


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A space, and the links whose way it may end.

    Args:
        space: with the voxels made free that these links may touch; nobody else gets to see it.
        volume: of the space, as kernels take it.
        links: whether each link is one of them, shape (n_links,).
    """

    space: FreeSpace
    volume: Volume
    links: NDArray[np.bool_]


def grounds_of(space: FreeSpace, machine: Machine) -> tuple[Ground, ...]:
    """One for each set of links that may touch the same boxes; each link is in one of them.

    Args:
        space: what the machine moves in.
        machine: says what its links may touch.
    """
    touches = [
        tuple(n for n, stand in enumerate(machine.stands) if stand.names(link)) for link in machine.link_names
    ]
    grounds = []
    for stands in sorted(set(touches)):
        own = space
        if stands:
            words = _words_in(machine.anywhere, space.grid, stands)
            own = replace(space, free_words=space.free_words | words)
        grounds.append(Ground(own, volume_of(own), np.array([touch == stands for touch in touches])))
    return tuple(grounds)


@kept
def _words_in(machine: Machine, grid: VoxelGrid, stands: tuple[int, ...]) -> Words:
    """The plane of the voxels that lie wholly in one of some of a machine's stands."""
    mask = np.zeros(grid.shape, dtype=np.bool_)
    for n in stands:
        mask[_voxels_in(machine.stands[n], grid)] = True
    return bits.pack(mask, grid)


def _voxels_in(stand: Stand, grid: VoxelGrid) -> tuple[slice, ...]:
    first = np.ceil((stand.lower_m - grid.lower_m) / grid.voxel_size_m - ROUNDING_IN_VOXELS)
    stop = np.floor((stand.upper_m - grid.lower_m) / grid.voxel_size_m + ROUNDING_IN_VOXELS)
    within = np.clip(np.stack([first, stop]), 0, grid.shape).astype(np.int64)
    return tuple(slice(int(a), int(b)) for a, b in within.T)
