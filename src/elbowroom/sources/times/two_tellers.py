"""Joints that two tell at once, or one whose clock was set back: not to be taken for another unit."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Joint
from elbowroom.sources.times.series import length_text

FELL_NS = 10_000_000
"""A clock that goes back by less is not seen [ns]."""
MOST_FALLS = 3
"""Stamps that fall more often are of several publishers, each with a delay of its own."""
NEAR = 5
"""So many messages before and after are compared."""
RETURNS, SHARE, LEAST_STEP = 3, 0.05, 0.05
"""Times that a joint goes to and fro at least, and the share of rows in which it does; steps beyond such [m or rad]."""

A_TURN = 0.5
"""A step that differs from a whole turn by less is one, of a joint without end [rad]."""


def clock_fall(topic: str, arrivals: NDArray[np.int64]) -> str | None:
    """That the clock of a topic went back, in words; None: it did not, as far as is seen.

    Args:
        topic: its name.
        arrivals: when its messages came and their stamps [ns], shape (n, 2), by time of receipt.
    """
    stamps, late = arrivals[:, 1], arrivals[:, 0] - arrivals[:, 1]
    falls = np.flatnonzero(np.diff(stamps) < -FELL_NS) + 1
    if not 0 < len(falls) <= MOST_FALLS:
        return None
    stays = [row for row in falls.tolist() if _stays(late, row, int(stamps[row - 1] - stamps[row]))]
    if not stays:
        return None
    row = max(stays, key=lambda one: int(stamps[one - 1] - stamps[one]))
    steps = np.diff(stamps)
    usual_ns = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    by_ns = stamps[row - 1] - stamps[row] + usual_ns
    return f"the clock of {topic} went back by {length_text(round(by_ns))} at {stamps[row - 1]} ns"


def _stays(late: NDArray[np.int64], row: int, fell_ns: int) -> bool:
    """Whether messages after a fall are late by about as much; one that came late alone is not."""
    before, after = late[max(0, row - NEAR) : row], late[row : row + NEAR]
    return len(after) > 1 and bool(after.min() - before.min() > fell_ns / 2)


def steps_of(joint: Joint, positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far a joint goes from row to row [m or rad]; one without end goes on where it is told within a turn.

    Args:
        joint: which.
        positions: of its rows, shape (n,) [m or rad].

    Returns:
        Shape (n - 1,).
    """
    steps: NDArray[np.float64] = np.diff(positions)
    is_turn = (np.abs(np.abs(steps) - 2 * np.pi) < A_TURN) & (joint.kind == "continuous")
    return steps - np.where(is_turn, np.copysign(2 * np.pi, steps), 0.0)


def to_and_fro(stamps_ns: NDArray[np.int64], steps: NDArray[np.float64], fast: float) -> Sequence[float]:
    """The steps from which a joint is back in the next row, faster than it can go, as where two tell it by turns.

    Args:
        stamps_ns: of its rows [ns].
        steps: of the joint from row to row, as of `steps_of` [m or rad].
        fast: no joint goes so fast [m/s or rad/s].

    Returns:
        Their lengths [m or rad]; none, where most fast steps are none of these.
    """
    is_fast = np.abs(steps) / (np.diff(stamps_ns) / 1e9) > fast
    there, back = steps[:-1], steps[1:]
    returns = is_fast[:-1] & is_fast[1:] & (np.abs(there + back) < 0.2 * np.abs(there))
    in_one = np.zeros(len(steps), dtype=np.bool_)
    in_one[:-1] |= returns
    in_one[1:] |= returns
    if returns.sum() < RETURNS or in_one.sum() < 0.5 * is_fast.sum():
        return ()
    lengths = np.abs(there[returns])
    return lengths.tolist() if np.median(lengths) > LEAST_STEP else ()
