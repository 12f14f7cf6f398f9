"""The first block on a way, on a GPU: as `motion.sweep.find_block`, with the same answer."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.gpu.device import cuda, launch
from elbowroom.gpu.kernels.sweep import Sweep, met_in, place_all
from elbowroom.gpu.kernels.threads import sweep_samples
from elbowroom.machine import Machine
from elbowroom.motion.block import Block
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.mover import Mover, Skin
from elbowroom.motion.kernels.sweep import MOST_MET
from elbowroom.motion.kernels.volume import Volume
from elbowroom.motion.sweep import halvings_of

AT_ONCE = 256
"""So many intervals are looked at in one launch, the first ones first."""


def find_block_on_gpu(
    machine: Machine, skin: Skin, speeds: NDArray[np.float64], way: Way, volume: Volume
) -> Block | None:
    """The first block that the swept body meets; every sample is asked in every interval, a thread for each.

    Args:
        machine, skin, way: what moves, and where to; a way without stops.
        speeds: of `motion.sweep.cluster_speeds`, shape (n_clusters,); 0 for those that are not asked.
        volume: of `motion.sweep.volume_of`.

    Returns:
        As `motion.sweep.find_block`, but that the sweep does not go on from there; None: nothing on the whole way.

    Raises:
        PackageError: numba-cuda is not installed.
    """
    cuda()
    if way.length == 0 or not (speeds > 0).any():
        return None
    intervals = 1 << halvings_of(way, speeds, volume)
    half = way.length / (2.0 * intervals)
    placed = np.empty((intervals, machine.tree.parent.size, 4, 4))
    place_all(Mover(machine.tree, machine.world_from_base, skin, way.course, speeds), half, placed)
    samples = np.flatnonzero(speeds[skin.cluster_of] > 0).astype(np.int32)
    for start in range(0, intervals, AT_ONCE):
        part = placed[start : start + AT_ONCE]
        first = np.array([len(part)])
        sweep = Sweep(part, skin, speeds, half, volume, samples, first)
        launch(sweep_samples, len(part) * len(samples), sweep)
        if first[0] < len(part):
            return _block(sweep, start)
    return None


def _block(sweep: Sweep, start: int) -> Block:
    """What is met in the first interval that has a block."""
    at = int(sweep.first[0])
    place, triangle, met = np.zeros(3), np.empty((3, 3)), np.empty(MOST_MET, dtype=np.int64)
    kind, by, count = met_in(sweep, at, place, triangle, met)
    return Block((start + at) * 2 * sweep.half, int(kind), int(by), place, met[:count])
