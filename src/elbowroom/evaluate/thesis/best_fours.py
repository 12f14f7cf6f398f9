"""Fours of candidates from where most ways are in view for which what is due holds."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.evaluate.thesis.scale import near_m
from elbowroom.evaluate.thesis.scale_model import VOXEL_M
from elbowroom.evaluate.thesis.seen_ways import Shown

STARTS = 20
MEDIAN_MM, WORST_MM = 4.8, 11.0
"""What is due, 5 and 12, with a little to spare, since other noise is judged."""
ALL_BUT_IN_VIEW = 2
"""The worst that is due is asked of ways that would be in view with so many times the limit, too.

Else the search puts what is bad just beyond it.
"""


def shortfalls(
    ways: Sequence[Shown], chosen: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """For three candidates and each further one: by how much each way is short of the contact.

    Returns:
        What is in view of none of the four, and what is not free by rule `three` [mm]; shape (candidates, ways).
    """
    hidden, blocked = [], []
    for way in ways:
        count = way.through[chosen].sum(axis=0, dtype=np.uint8) + way.through
        disputed = way.disputed[chosen].any(axis=0) | way.disputed
        hidden.append(_first_missing(way, way.in_view[chosen].any(axis=0) | way.in_view))
        blocked.append(_first_missing(way, (count >= 3) | ((count >= 1) & ~disputed)))
    return np.array(hidden).T, np.array(blocked).T


def _first_missing(way: Shown, has: NDArray[np.bool_]) -> NDArray[np.float64]:
    first = np.where(has.all(axis=1), has.shape[1], np.argmin(has, axis=1))
    return way.short_mm[first]


def scores(hidden_mm: NDArray[np.float64], blocked_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """The ways in view for which what is due holds, four less for each that is too short by the worst."""
    in_view = hidden_mm <= 1000 * near_m(VOXEL_M)
    good = (in_view & (blocked_mm <= MEDIAN_MM)).sum(axis=1)
    near = hidden_mm <= 1000 * ALL_BUT_IN_VIEW * near_m(VOXEL_M)
    bad = (near & (blocked_mm > WORST_MM)).sum(axis=1)
    # the last term gives the search a slope to climb
    slope = np.clip(1 - blocked_mm / 60, 0, 1).mean(axis=1)
    return np.minimum(in_view.sum(axis=1), 2 * good - 1) - 4 * bad + 0.5 * slope


def best_fours(ways: Sequence[Shown], count: int) -> list[tuple[float, list[int]]]:
    """Fours of candidates that cannot be bettered by exchanging one, the best first, with their scores."""
    rng, found = np.random.default_rng(0), {}
    for _ in range(STARTS):
        chosen, best, better = rng.choice(count, 4, replace=False).tolist(), -np.inf, True
        while better:
            better = False
            for n in range(4):
                now = scores(*shortfalls(ways, chosen[:n] + chosen[n + 1 :]))
                if now.max() > best + 1e-9:
                    best, chosen[n], better = float(now.max()), int(now.argmax()), True
        found[tuple(sorted(chosen))] = best
    return sorted(((best, list(four)) for four, best in found.items()), reverse=True)
