"""What ends a way: the first block that the swept body meets."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Block(NamedTuple):
    """The first block on a way: its travel, its kind (as kernels number it), the cluster that meets it."""

    travel: float
    kind: int
    cluster: int
    place_in_world: NDArray[np.float64]
