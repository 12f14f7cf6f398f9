"""A test that listens frame by frame until it is sure."""

from dataclasses import dataclass, field

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
