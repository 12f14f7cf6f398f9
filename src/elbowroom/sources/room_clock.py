"""Stamps of several cameras on one clock, the monitor's, each with a bound of how much older its frame may be."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from elbowroom.finding import Finding
from elbowroom.sources.times.clock import Clock, ClockEstimate
from elbowroom.sources.times.series import length_text

OTHER_CLOCK_NS = 1_000_000_000
"""Stamps that are farther than this from when images come count by another clock than the monitor's [ns]."""
LEAST_DELAY_NS = 50_000_000
"""Of such a camera, and of one without stamps, an image takes no longer than this on its quickest way, from the middle
of its exposure on: no stamp says it [ns]."""


class RoomTime(NamedTuple):
    """When an image was exposed, by the monitor's clock.

    Args:
        stamp_ns: [ns].
        bound_ns: how much earlier that may have been [ns].
    """

    stamp_ns: int
    bound_ns: int


@dataclass(slots=True, eq=False)
class RoomClock:
    """Hears when each camera's images come, and says when they were exposed by the clock of the monitor.

    - A camera on the monitor's clock keeps its stamps. Where they are ahead of it, so that an image would come before
      it was exposed, they are taken back by as much.
    - One whose stamps count otherwise is known once its clock is settled; its quickest image is taken to have come at
      once, and the bound holds `LEAST_DELAY_NS`.
    - One without stamps is given the times of receipt, with the same bound.

    Args:
        stampless: cameras whose stamps are times of receipt.
    """

    stampless: frozenset[str] = frozenset()
    _clocks: dict[str, Clock] = field(default_factory=dict, init=False)

    def hear(self, camera: str, arrival_ns: int, stamp_ns: int) -> None:
        """An image came.

        Args:
            camera: whose.
            arrival_ns: when [ns, the monitor's clock].
            stamp_ns: its stamp [ns, the camera's clock].
        """
        self._clocks.setdefault(camera, Clock()).hear(arrival_ns, stamp_ns)

    def estimates(self, now_ns: int) -> Mapping[str, ClockEstimate]:
        """What is known of each camera that was heard and has stamps."""
        found = {name: clock.at(now_ns) for name, clock in self._clocks.items() if name not in self.stampless}
        return {name: estimate for name, estimate in found.items() if estimate is not None}

    def of(self, camera: str, stamp_ns: int, now_ns: int) -> RoomTime | None:
        """When an image was exposed; None: its clock is another one, and not known yet.

        Args:
            camera: whose; it was heard.
            stamp_ns: its stamp [ns, the camera's clock].
            now_ns: [ns, the monitor's clock].
        """
        if camera in self.stampless:
            return RoomTime(stamp_ns, LEAST_DELAY_NS)
        estimate = self._clocks[camera].at(now_ns)
        assert estimate is not None
        if not is_other(estimate):
            return RoomTime(stamp_ns + min(estimate.offset_ns, 0), estimate.bound_ns)
        if not estimate.is_settled:
            return None
        return RoomTime(stamp_ns + estimate.offset_ns, estimate.bound_ns + LEAST_DELAY_NS)

    def findings(self, now_ns: int) -> tuple[Finding, ...]:
        """Cameras whose clocks are not the monitor's; none of it stops."""
        return tuple(
            Finding("clock", (name,), text, False)
            for name, estimate in self.estimates(now_ns).items()
            if (text := clock_text(name, estimate)) is not None
        )


def is_other(estimate: ClockEstimate) -> bool:
    """Whether a camera counts by another clock."""
    return abs(estimate.offset_ns) > OTHER_CLOCK_NS


def clock_text(camera: str, estimate: ClockEstimate) -> str | None:
    """That a camera's clock is not the monitor's, and what is made of it; None: it may well be.

    Args:
        camera: its name.
        estimate: of its clock.
    """
    apart, bound = length_text(estimate.offset_ns), length_text(estimate.bound_ns)
    if is_other(estimate):
        way = "behind" if estimate.offset_ns > 0 else "ahead of"
        known = (
            f"its stamps are moved by that, within {bound}, and its images taken to need {length_text(LEAST_DELAY_NS)} "
            "at most on their quickest way"
            if estimate.is_settled
            else "it counts once its clock is known, in a second"
        )
        return f"camera {camera}: its clock is {apart} {way} that of the monitor: {known}"
    if estimate.offset_ns < -estimate.bound_ns:
        return (
            f"camera {camera}: its stamps are {apart} ahead of when its images come: its clock is ahead; they are "
            f"taken back by that, within {bound}"
        )
    return None
