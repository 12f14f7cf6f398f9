"""A fixed piece of work."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def reference(values):
    """Half arithmetic and half look-up, always the same: computers are compared by the time it takes.

    Args:
        values: float32, shape (2**18,).
    """
    total = 0.0
    index = 1
    for _ in range(2_000_000):
        index = (index * 1103515245 + 12345) & 0x3FFFF
        total += np.sqrt(values[index] + 1.0)
    return total
