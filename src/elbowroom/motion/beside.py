"""The first stop from a path that does not stay free beside it, where each joint brakes by itself."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.motion.block import Block
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.beside import Cutting, block_in_box, near_in_box
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.kernels.touched import NOTHING
from elbowroom.motion.kernels.volume import Volume

FINEST_IN_VOXELS, FINEST_SHARED_IN_VOXELS = 1 / 16, 1 / 32
"""A box is cut until no point moves farther in it; and where the machine reaches into blocked voxels as it stands, no
farther than half of what a body is grown by there (`motion.shared`) [voxel edges]."""
FINEST_STEP_IN_VOXELS = 1 / 4
"""The moment of the first blocked stop is found to within what moves no point farther [voxel edges]."""
MOST_BOXES = 20_000
"""So many parts of one box are looked at; what is not known to be free then is blocked."""


def first_stop_blocked(
    machine: Machine, skin: Skin, speeds: NDArray[np.float64], way: Way, volume: Volume
) -> Block | None:
    """The first stop that meets a block, its travel the time at which it is commanded; None: all are free.

    Args:
        machine, skin: what moves.
        speeds: of its clusters along the way [m/s]; 0 for those that are not asked.
        way: with stops.
        volume: what is blocked.
    """
    stops, edge = way.stops, volume.lattice.edge
    finest = (FINEST_IN_VOXELS if volume.shared.others else FINEST_SHARED_IN_VOXELS) * edge
    step = FINEST_STEP_IN_VOXELS * edge
    assert stops is not None
    moving = np.flatnonzero(speeds > 0).astype(np.int32)
    cutting, asked = Cutting(finest, MOST_BOXES), moving

    def begin(begin_s: float, end_s: float) -> None:
        nonlocal asked
        box = stops.box(begin_s, end_s)
        asked = near_in_box(machine.tree, machine.world_from_base, skin, box, volume, moving)

    def look(begin_s: float, end_s: float) -> Block | None:
        box = stops.box(begin_s, end_s)
        kind, cluster, place = block_in_box(
            machine.tree, machine.world_from_base, skin, box, volume, asked, cutting
        )
        return None if kind == NOTHING else Block(begin_s, kind, cluster, place)

    found = stops.first(way.length, step / float(speeds.max()), look, begin)
    return None if found is None else found[1]._replace(travel=found[0])
