"""Windows in time: when a motion should have stopped, when it was stopped, and how both go together."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Window(NamedTuple):
    """A time in which a motion should have stopped.

    Fields:
        first, last: its first tick and the one after its last.
        lag: ticks until it was stopped; 0: it was when the window began; None: it never was in it.
        is_missed: whether it was not stopped at some tick later than a reaction after the window's first.
    """

    first: int
    last: int
    lag: int | None
    is_missed: bool


def runs_of(mask: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Where a mask is true without a gap: first, and one after the last; mask of shape (n,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def windows_of(should: NDArray[np.bool_], stopped: NDArray[np.bool_], reaction: int) -> list[Window]:
    """Windows in which a motion should have stopped.

    Args:
        should: by tick, whether exact geometry says so, shape (n,).
        stopped: by tick, whether the decision that holds is stop, shape (n,).
        reaction: so many ticks of a window are the reaction time: in these it need not be stopped yet.
    """
    found = []
    for first, last in runs_of(should):
        within = np.flatnonzero(stopped[first:last])
        due = stopped[first + reaction : last]
        found.append(Window(first, last, int(within[0]) if within.size else None, not bool(due.all())))
    return found


def needless_of(
    should: NDArray[np.bool_], stopped: NDArray[np.bool_], reaction: int
) -> list[tuple[int, int]]:
    """Windows in which a motion was stopped for nothing: it should not have been in them, nor a reaction time before.

    Args:
        should, stopped, reaction: as of `windows_of`.
    """
    return [
        (first, last) for first, last in runs_of(stopped) if not should[max(0, first - reaction) : last].any()
    ]


def share_pct(ticks: Sequence[tuple[int, int]], of: int) -> float:
    """The share of some windows in a time of so many ticks [%]."""
    return 100 * sum(last - first for first, last in ticks) / max(1, of)
