"""When images are due, so that a pass begins with young ones: how long it is worth to wait for those that come soon."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import median
from typing import NamedTuple

HEARD = 9
"""Of so many arrivals the period of a camera is the median of what lies between."""
PRICE = 1 / 7
"""A millisecond of waiting is worth it where images are younger by so many on average. Of cameras that expose together
those are awaited of which an eighth of the period is over; of cameras that run free at most the next image is."""
LEAST = 3
"""After so many images a camera's period is known."""
SLACK, STEP = 0.25, 1 / 32
"""An image that is late by this share of its period is not awaited any more; till then it is due after a step more."""


@dataclass(slots=True, eq=False)
class Cadence:
    """Hears when images come. What an image costs grows with its age: a voxel that was seen free some while ago has to
    be seen free far about it, so that a pass with images of 67 ms takes twice as long as one with new ones, and frees
    less. Whoever is slower than the cameras does better to wait for the next images than to begin with old ones.
    """

    _came_ns: dict[str, deque[int]] = field(default_factory=dict, init=False)

    def come(self, camera: str, at_ns: int) -> None:
        """An image has come; each is told, also those that nobody will look at.

        Args:
            camera: its name.
            at_ns: when it came [ns].
        """
        self._came_ns.setdefault(camera, deque(maxlen=HEARD)).append(at_ns)

    def worth_until_ns(self, now_ns: int, asked_ns: int) -> int:
        """Until when to wait [ns]; `now_ns`: not at all. Ask again whenever an image comes before.

        It is the moment at which the mean age of the newest images, and `PRICE` times the wait, is least; and no later
        than the shortest period after `asked_ns`, so that a camera that gives nothing any more holds nobody up.

        Args:
            now_ns: the time now [ns].
            asked_ns: since when a pass could have begun [ns].
        """
        awaited = [_awaited(times, now_ns) for times in self._came_ns.values()]
        periods_ns = [each.period_ns for each in awaited if each.due_ns is not None]
        if not periods_ns:
            return now_ns
        last_ns = asked_ns + min(periods_ns)
        due_ns = sorted(
            {each.due_ns for each in awaited if each.due_ns is not None and each.due_ns <= last_ns}
        )
        return min((now_ns, *due_ns), key=lambda at_ns: _cost(awaited, at_ns, now_ns))


class _Awaited(NamedTuple):
    """A camera's newest image and the next.

    Fields:
        newest_ns: when it came [ns].
        due_ns: when the next is there [ns]; None: it is not awaited.
        period_ns: between two.
    """

    newest_ns: int
    due_ns: int | None
    period_ns: float


def _awaited(times_ns: Sequence[int], now_ns: int) -> _Awaited:
    if len(times_ns) < LEAST:
        return _Awaited(times_ns[-1], None, 0.0)
    period_ns = median(after - before for before, after in pairwise(times_ns))
    due_ns = times_ns[-1] + period_ns
    if period_ns <= 0 or now_ns > due_ns + SLACK * period_ns:
        return _Awaited(times_ns[-1], None, period_ns)
    return _Awaited(times_ns[-1], round(due_ns if due_ns > now_ns else now_ns + STEP * period_ns), period_ns)


def _cost(awaited: Sequence[_Awaited], at_ns: int, now_ns: int) -> float:
    """What beginning then costs: the mean age of images, and the wait [ns]."""
    ages_ns = [
        at_ns - (each.newest_ns if each.due_ns is None or each.due_ns > at_ns else each.due_ns)
        for each in awaited
    ]
    return sum(ages_ns) / len(ages_ns) + PRICE * (at_ns - now_ns)
