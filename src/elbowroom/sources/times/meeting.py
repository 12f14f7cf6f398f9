"""Which images of several cameras make a moment: those that lie near in time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.sources.times.series import Series

MAX_STEPS = 3
"""An image more than so many usual steps away is of another moment, whatever `max_skew_ms` allows: between them its
camera lost images. This limit does not hang on the unit of the stamps."""
UNSURE_STEPS = 0.75
"""Where stamps may be in another unit than nanoseconds, an image is of the moment that it is nearest to alone."""
SECOND_NS = 1_000_000_000
USUAL_HZ = 61
"""Most depth cameras give no more images a second."""
DATED_NS = 1_420_070_400 * SECOND_NS, 2_051_222_400 * SECOND_NS
"""From 2015 to 2035 [ns since 1970]: when recordings are made. As microseconds the same numbers are 16 to 24 days."""
LONGEST_WAIT_S = 60.0
SHORTEST_GAP_S = 5.0
GAP_IN_STEPS = 20
"""A gap is longer than so many usual steps between moments, within these two limits [s]."""


@dataclass(frozen=True, slots=True, eq=False)
class Meeting:
    """The moments of a recording: each is around an image of the camera that has most.

    Args:
        series: of all cameras; one of them has images.
        max_skew_ns: images farther from that of the leading camera are of no use to its moment [ns].
        declared: whether the site says in which unit stamps are.
    """

    series: Sequence[Series]
    max_skew_ns: int
    declared: bool = False

    @property
    def lead(self) -> Series:
        """Of the camera that has most images; the first of several."""
        return max(self.series, key=len)

    def taken(self) -> NDArray[np.int64]:
        """Which image of each camera is part of each moment, shape (cameras, moments); -1: none."""
        return np.stack([self._near(row, self.limit_ns(row)) for row in self.series])

    def nearest_ns(self, row: Series) -> NDArray[np.int64]:
        """How far a camera's nearest image is from each moment's leading one [ns], shape (moments,)."""
        index = _nearest(row.stamps_ns, self.lead.stamps_ns)
        return np.abs(row.stamps_ns[index] - self.lead.stamps_ns)

    def too_many_steps(self, row: Series) -> int:
        """In how many moments a camera's image is near enough by `max_skew_ns`, but of another moment by its steps."""
        if not len(row):
            return 0
        away = self.nearest_ns(row)
        return int(((away <= self.max_skew_ns) & (away > self.limit_ns(row))).sum())

    def skews_ns(self) -> NDArray[np.int64]:
        """Between the first and the last image of each moment [ns], shape (moments,)."""
        taken = self.taken()
        earliest = self.lead.stamps_ns.copy()
        latest = earliest.copy()
        for row, index in zip(self.series, taken, strict=True):
            there = index >= 0
            earliest[there] = np.minimum(earliest[there], row.stamps_ns[index[there]])
            latest[there] = np.maximum(latest[there], row.stamps_ns[index[there]])
        return latest - earliest

    @property
    def unsure(self) -> bool:
        """Whether stamps may well be microseconds, where the site does not say: as nanoseconds all images lie in the
        first second of their clock and come faster than most cameras give them, or as microseconds they are dates.
        """
        if self.declared:
            return False
        first, last, step = self.lead.first_ns, self.lead.last_ns, self.lead.step_ns
        dated = 1_000 * first > DATED_NS[0] and 1_000 * last < DATED_NS[1]
        return dated or (last < SECOND_NS and step is not None and step < SECOND_NS / USUAL_HZ)

    @property
    def gap_ns(self) -> int:
        """Nothing for longer than this is a gap [ns]."""
        return gap_ns(self.lead.step_ns)

    def limit_ns(self, row: Series) -> int:
        """How far a camera's image may be from a moment's leading one to be part of it [ns]."""
        steps = [step for step in (row.step_ns, self.lead.step_ns) if step is not None]
        most = UNSURE_STEPS if self.unsure else MAX_STEPS
        return min(self.max_skew_ns, round(most * max(steps))) if steps else self.max_skew_ns

    def _near(self, row: Series, limit_ns: int) -> NDArray[np.int64]:
        if not len(row):
            return np.full(len(self.lead), -1)
        index = _nearest(row.stamps_ns, self.lead.stamps_ns)
        return np.where(self.nearest_ns(row) <= limit_ns, index, -1)


def gap_ns(step_ns: float | None) -> int:
    """How long nothing has to come to be a gap [ns], where moments usually come every `step_ns`; None: not known."""
    steps_s = 0.0 if step_ns is None else GAP_IN_STEPS * step_ns / 1e9
    return round(1e9 * min(max(steps_s, SHORTEST_GAP_S), LONGEST_WAIT_S))


def _nearest(stamps_ns: NDArray[np.int64], asked_ns: NDArray[np.int64]) -> NDArray[np.int64]:
    """Of rising stamps the nearest to each that is asked for; the earlier of two that are equally near."""
    after = np.minimum(np.searchsorted(stamps_ns, asked_ns), len(stamps_ns) - 1)
    before = np.maximum(after - 1, 0)
    is_before = np.abs(stamps_ns[before] - asked_ns) <= np.abs(stamps_ns[after] - asked_ns)
    return np.where(is_before, before, after)
