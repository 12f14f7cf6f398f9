"""What ends a way: the first block that the swept body meets."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.motion.kernels.sweep import Asked


class Block(NamedTuple):
    """The first block on a way: its travel, its kind (as kernels number it), the cluster that meets it, where; the
    numbers of all voxels that are met there, and from where the sweep can go on."""

    travel: float
    kind: int
    cluster: int
    place_in_world: NDArray[np.float64]
    met: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
    asked: Asked | None = None
