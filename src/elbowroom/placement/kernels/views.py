"""Of the cameras that see each voxel: how many, and how many of them pairwise far enough apart seen from above."""

import math

import numpy as np
from numba import njit

ABOVE_M = 1e-9
"""A camera no farther aside than this is straight above or below: it has no direction in the horizontal plane."""
TURN = 2.0 * math.pi


@njit(cache=True, nogil=True)
def count_views(seen, eyes, x, y, angle, tie, count, apart):
    """Fills count and apart for the columns of voxels at one x.

    Args:
        seen: bool, shape (cameras, ny, nz).
        eyes: the cameras' centres, shape (cameras, 3) [m].
        x: of the columns [m].
        y: of each column, shape (ny,) [m].
        angle: least angle between two views [rad].
        tie: by how much less still counts [rad].
        count: uint8, shape (ny, nz), written: cameras that see the voxel.
        apart: uint8, shape (ny, nz), written: size of the largest set of them that are pairwise the angle apart.
    """
    cameras, ny, nz = seen.shape
    azimuth = np.empty(cameras)
    angles = np.empty(cameras)
    for j in range(ny):
        aside = 0
        for c in range(cameras):
            dx, dy = eyes[c, 0] - x, eyes[c, 1] - y[j]
            if math.hypot(dx, dy) > ABOVE_M:
                azimuth[c] = math.atan2(dy, dx)
                aside += 1
            else:
                azimuth[c] = np.inf
        order = np.argsort(azimuth, kind="mergesort")
        for k in range(nz):
            same = k > 0
            total = 0
            for c in range(cameras):
                total += seen[c, j, k]
                if k > 0 and seen[c, j, k] != seen[c, j, k - 1]:
                    same = False
            count[j, k] = min(total, 255)
            if same:
                apart[j, k] = apart[j, k - 1]
                continue
            m = 0
            for n in range(aside):
                if seen[order[n], j, k]:
                    angles[m] = azimuth[order[n]]
                    m += 1
            best = largest_apart(angles, m, angle, tie)
            apart[j, k] = min(max(best, 1 if total > 0 else 0), 255)


@njit(cache=True, nogil=True)
def largest_apart(angles, m, angle, tie):
    """Size of the largest set of the first m sorted angles whose members are pairwise at least `angle` apart.

    From a first member on, taking the next that is far enough is never worse than a later one; so it is enough to
    try every member as the first.
    """
    best = min(m, 1)
    for first in range(m):
        size = 1
        last = angles[first]
        for n in range(1, m):
            at = first + n
            here = angles[at] if at < m else angles[at - m] + TURN
            if here - last >= angle - tie and angles[first] + TURN - here >= angle - tie:
                size += 1
                last = here
        best = max(best, size)
    return best
