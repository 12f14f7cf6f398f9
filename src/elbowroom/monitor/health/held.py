"""A cause that comes with its evidence and goes with evidence of its own alone: one pure step."""

from dataclasses import dataclass, replace
from typing import Self


@dataclass(frozen=True, slots=True)
class Held:
    """Whether one cause is there.

    Args:
        after: so many bad signs in a row bring it.
        clears_after: so many good signs in a row, once it is there, end it.
        is_there: whether it is.
        bad: bad signs in a row, up to now.
        good: good ones in a row since it is there.
    """

    after: int = 1
    clears_after: int = 3
    is_there: bool = False
    bad: int = 0
    good: int = 0

    def hearing(self, is_bad: bool | None) -> Self:
        """The same after one more sign.

        Args:
            is_bad: what it says; None: it cannot tell, and so changes nothing.
        """
        if is_bad is None or not (is_bad or self.is_there or self.bad):
            return self
        if is_bad:
            bad = min(self.bad + 1, self.after)
            return replace(self, bad=bad, good=0, is_there=self.is_there or bad >= self.after)
        good = self.good + 1 if self.is_there else 0
        is_there = self.is_there and good < self.clears_after
        return replace(self, bad=0, good=good if is_there else 0, is_there=is_there)
