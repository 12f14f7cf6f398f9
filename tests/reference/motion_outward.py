"""How far a triangle moves outward in a box as plain as can be: at many of its places."""

import numpy as np

STEPS = 60


def most_in(triangle, moved, low, edge):
    """The greatest of values given at a triangle's corners, at many places of it in a box; 0: none is above."""
    i, j = np.meshgrid(np.arange(STEPS + 1), np.arange(STEPS + 1), indexing="ij")
    some = i + j <= STEPS
    share = np.stack([STEPS - i[some] - j[some], i[some], j[some]], axis=1) / STEPS
    places = share @ triangle
    inside = ((places >= low) & (places <= np.asarray(low) + edge)).all(axis=1)
    return max(0.0, (share[inside] @ moved).max(initial=0.0))
