"""Kernels of rectification: arrays and floats only."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def bounds_of_contributors(raw, contributors, shallowest, deepest, least, greatest):
    """Per pinhole pixel the nearest and farthest raw pixel of a rectangle; 0 in both unless all are valid.

    Args:
        raw: shape (h, w), float32 [m].
        contributors: first_u, last_u, first_v and last_v by pinhole pixel, shape (h, w), int16; first_u below 0
            marks a pixel without.
        shallowest, deepest: range in which a depth is a return [m].
        least, greatest: shape (h, w), float32 [m]; written.
    """
    height, width = raw.shape
    first_u, last_u = contributors.first_u, contributors.last_u
    first_v, last_v = contributors.first_v, contributors.last_v
    for v in range(height):
        for u in range(width):
            least[v, u] = 0.0
            greatest[v, u] = 0.0
            if first_u[v, u] < 0:
                continue
            low = np.float32(np.inf)
            high = np.float32(0.0)
            valid = True
            for row in range(first_v[v, u], last_v[v, u] + 1):
                for column in range(first_u[v, u], last_u[v, u] + 1):
                    depth = raw[row, column]
                    # a comparison with NaN is false, so NaN makes the pixel invalid
                    valid &= (depth > 0.0) & (depth >= shallowest) & (depth <= deepest) & (depth < np.inf)
                    low = min(low, depth)
                    high = max(high, depth)
            if valid:
                least[v, u] = low
                greatest[v, u] = high
