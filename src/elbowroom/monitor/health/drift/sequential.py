"""A test that listens frame by frame until it is sure."""

from dataclasses import dataclass, field

import numpy as np

from elbowroom.errors import InputError


@dataclass(slots=True)
class Tally:
    """A one-sided CUSUM test (Page, Biometrika 41, 1954) of frames that say yes, no, or nothing.

    A yes adds one, a no takes two away, never below zero; at `limit` the test has decided, and stays so. From frames
    that say yes in a third of the time or less it drifts down, from others up.

    Args:
        limit: so many more have to say yes; at least 1.
    """

    limit: int
    score: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        if self.limit < 1:
            raise InputError(f"tally: limit is {self.limit}, must be at least 1")

    def add(self, says: bool | None) -> bool:
        """Hears one frame; None says nothing. Whether the test has decided."""
        if not self.decided and says is not None:
            self.score = self.score + 1 if says else max(self.score - 2, 0)
        return self.decided

    @property
    def decided(self) -> bool:
        """Whether enough frames said yes."""
        return self.score >= self.limit


def mean_run_length(limit: int, share: float) -> float:
    """Frames until a `Tally` decides, on average, if each says yes with one probability, whatever others say.

    Exact: mean absorption time of its Markov chain. Frames of real rooms hang together, so this is no promise; it says
    how rare wrong frames have to be.

    Args:
        limit: of the tally.
        share: probability that a frame says yes, between 0 and 1, neither included.
    """
    if not 0 < share < 1:
        raise InputError(f"mean_run_length: share is {share}, must be between 0 and 1")
    # time from score s to s + 1, by where a no leads: t[s] = 1 + (1 - share) (t[down] + ... + t[s]), solved for t[s]
    up = np.zeros(limit)
    for s in range(limit):
        down = max(s - 2, 0)
        up[s] = (1 + (1 - share) * up[down:s].sum()) / share
    return float(up.sum())
