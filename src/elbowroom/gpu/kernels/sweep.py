"""Whether one sample's triangles meet a block in one interval of a way: a thread of the GPU for each of both."""

from typing import NamedTuple

import numpy as np
from numba import njit

from elbowroom.geometry.kernels.bits import uncounted
from elbowroom.motion.kernels.mover import Skin, place_at
from elbowroom.motion.kernels.touched import NOTHING, list_touched, touched_block
from elbowroom.motion.kernels.volume import Volume


class Sweep(NamedTuple):
    """All of a sweep.

    Fields:
        placed: where links are in the middle of each interval, (intervals, links, 4, 4).
        skin, speeds: of what moves (`motion.kernels.mover`).
        half: half an interval's travel.
        volume: what is blocked.
        samples: those that move, (n,) int32.
        first: takes the first interval with a block, (1,) int64; how many there are, before.
    """

    placed: np.ndarray
    skin: Skin
    speeds: np.ndarray
    half: float
    volume: Volume
    samples: np.ndarray
    first: np.ndarray


@njit(cache=True, nogil=True)
def place_all(mover, half, placed):
    """Fills where links are in the middle of each interval.

    Args:
        mover: what moves, and where to.
        half: half an interval's travel.
        placed: (intervals, links, 4, 4).
    """
    for interval in range(placed.shape[0]):
        place_at(mover, (2 * interval + 1) * half, placed[interval : interval + 1])


@uncounted(cache=True)
def met_in(sweep, interval, place, triangle, met):
    """What is met in an interval, as `touched_block` and `list_touched` say it: kind, place's sample, how many.

    Args:
        sweep: all of it.
        interval: which.
        place, triangle: (3,) and (3, 3); the first is where, the second room to work in.
        met: the numbers of the voxels that are met.
    """
    placed = sweep.placed[interval]
    kind, by = touched_block(placed, sweep, sweep.half, sweep.volume, sweep.samples, place, triangle)
    return kind, by, list_touched(placed, sweep, sweep.half, sweep.volume, sweep.samples, triangle, met)


@uncounted(cache=True)
def meets_block(sweep, interval, number, place, triangle):
    """Whether a sample's triangles, grown by their movement, meet a block in an interval.

    Args:
        sweep: all of it.
        interval: which.
        number: of the sample, among those that move.
        place, triangle: (3,) and (3, 3), room to work in.
    """
    sample = sweep.samples[number : number + 1]
    kind, _ = touched_block(sweep.placed[interval], sweep, sweep.half, sweep.volume, sample, place, triangle)
    return kind != NOTHING
