"""A camera's clock beside the monitor's: how far apart they are, how fast that changes, and how surely that is known.

All that is seen is when an image came, by the monitor's clock, and when it was exposed, by the camera's. The difference
is what the clocks are apart, and the delay of that image on the way; delays vary and are never below the least. So the
line below all differences, as high as it goes, is what the clocks are apart with the least delay (Moon, Skelly and
Towsley 1999; Zhang, Liu and Xia 2002). What the least delay is no stamp can say.
"""

import itertools
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypedDict

WINDOW_NS, BUCKET_NS = 10_000_000_000, 500_000_000
"""Differences of so long are kept [ns], the least of each of these parts of it."""
DRIFT_LIMIT = 200e-6
"""No clock of a camera or a computer goes faster or slower than another by more than this share."""
SETTLED_NS = 1_000_000_000
"""After so long a camera's clock is known [ns]."""


class ClockRow(TypedDict):
    """An estimate as numbers of a row."""

    offset_ms: float
    drift_ppm: float
    bound_ms: float
    settled: bool


class ClockEstimate(NamedTuple):
    """What is known of a camera's clock at a time.

    Args:
        offset_ns: the monitor's clock less the camera's, with the least delay of an image [ns].
        drift_ppm: by how much that grows in a second [us]; the camera's clock is slow where it does.
        bound_ns: the truth is no farther from the line than this, with the least delay of the window, at any time in it
            [ns]: as far as the least differences scatter, and as far as two clocks can part in it.
        is_settled: whether images have come for long enough.
    """

    offset_ns: int
    drift_ppm: float
    bound_ns: int
    is_settled: bool

    @property
    def row(self) -> ClockRow:
        """As numbers of a row: offset and bound [ms], drift [ppm]."""
        return ClockRow(
            offset_ms=self.offset_ns / 1e6,
            drift_ppm=self.drift_ppm,
            bound_ms=self.bound_ns / 1e6,
            settled=self.is_settled,
        )


@dataclass(slots=True, eq=False)
class Clock:
    """Hears of a camera's images, one after the other, and says what its clock is beside the monitor's.

    Args:
        window_ns: images of so long are remembered [ns].
        bucket_ns: of each part of it the least difference [ns].
        drift_limit: as `DRIFT_LIMIT`.
    """

    window_ns: int = WINDOW_NS
    bucket_ns: int = BUCKET_NS
    drift_limit: float = DRIFT_LIMIT
    _least: deque[tuple[int, int]] = field(default_factory=deque, init=False)
    _first_ns: int | None = field(default=None, init=False)

    def hear(self, arrival_ns: int, stamp_ns: int) -> None:
        """An image came. What comes with an arrival before the one before begins anew: that clock was set.

        Args:
            arrival_ns: when [ns, the monitor's clock].
            stamp_ns: when it was exposed [ns, the camera's clock].
        """
        apart = arrival_ns - stamp_ns
        least = self._least
        if least and arrival_ns // self.bucket_ns < least[-1][0] // self.bucket_ns:
            least.clear()
            self._first_ns = None
        if self._first_ns is None:
            self._first_ns = arrival_ns
        if not least or arrival_ns // self.bucket_ns != least[-1][0] // self.bucket_ns:
            least.append((arrival_ns, apart))
        elif apart < least[-1][1]:
            least[-1] = arrival_ns, apart
        while arrival_ns - least[0][0] > self.window_ns:
            least.popleft()

    def at(self, now_ns: int) -> ClockEstimate | None:
        """What is known at a time; None: no image has come.

        Args:
            now_ns: [ns, the monitor's clock].
        """
        if not self._least or self._first_ns is None:
            return None
        start = self._least[0][0]
        points = [(at - start, apart) for at, apart in self._least]
        slope = min(max(_slope(lower_hull(points)), -self.drift_limit), self.drift_limit)
        now = now_ns - start
        # differences of epochs are beyond what a float holds to the nanosecond
        base = points[0][1]
        above = [(apart - base) - slope * (at - now) for at, apart in points]
        low, high = min(above), max(above)
        parted = 2 * self.drift_limit * (max(self.window_ns, now) + self.bucket_ns)
        return ClockEstimate(
            base + round(low),
            slope * 1e6,
            round(high - low + parted),
            self._least[-1][0] - self._first_ns >= SETTLED_NS,
        )


def lower_hull(points: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """The corners of the line below all points, as high as it goes and never bending down, from left to right.

    Args:
        points: x and y, x strictly rising.
    """
    hull: list[tuple[int, int]] = []
    for x, y in points:
        while len(hull) > 1 and _turns_down(hull[-2], hull[-1], (x, y)):
            hull.pop()
        hull.append((x, y))
    return hull


def _turns_down(one: tuple[int, int], two: tuple[int, int], three: tuple[int, int]) -> bool:
    """Whether the middle one of three points lies on or above the line between the others."""
    return (two[1] - one[1]) * (three[0] - one[0]) >= (three[1] - one[1]) * (two[0] - one[0])


def _slope(hull: Sequence[tuple[int, int]]) -> float:
    """Of the hull over the middle of its span, where both sides have had their say; 0 of one point."""
    if len(hull) < 2:
        return 0.0
    middle = (hull[0][0] + hull[-1][0]) / 2
    left, right = next((a, b) for a, b in itertools.pairwise(hull) if b[0] >= middle)
    return (right[1] - left[1]) / (right[0] - left[0])
