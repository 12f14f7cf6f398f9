"""The joints of a bag that is played: the last that had come, on the room's clock, and how late they come."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import JointsError
from elbowroom.finding import Finding
from elbowroom.sensing import DepthFrame, JointRecord
from elbowroom.sources.joint_clock import joint_clock_text
from elbowroom.sources.room_clock import RoomClock
from elbowroom.sources.times.series import length_text


class Where(NamedTuple):
    """Where the machine is, as far as it had been said.

    Args:
        now_at: by the last row that had come [m or rad].
        at_frame: at each frame's time, by camera.
        velocities: by that row [m/s or rad/s].
        said_ns: when that row was so [ns, the room's clock].
    """

    now_at: Mapping[str, float]
    at_frame: Mapping[str, Mapping[str, float]]
    velocities: Mapping[str, float]
    said_ns: int


@dataclass(slots=True, eq=False)
class PlayedJoints:
    """Hears the messages of a bag as they come, and says where the machine is by those that had.

    Args:
        record: all that is said in the bag, with when each row had come.
        arrivals: of each topic its messages' times of receipt and stamps [ns], shape (n, 2), by time of receipt.
    """

    record: JointRecord
    arrivals: Mapping[str, NDArray[np.int64]]
    clock: RoomClock = field(default_factory=RoomClock, init=False)
    _done: dict[str, int] = field(default_factory=dict, init=False)
    _received_ns: NDArray[np.int64] = field(init=False)
    _newest: NDArray[np.int64] = field(init=False)
    """Of those rows that had come with each of `_received_ns` the newest stamp [ns]."""

    def __post_init__(self) -> None:
        stamps = self.record.stamps_ns
        received = stamps if self.record.received_ns is None else self.record.received_ns
        order = np.argsort(received, kind="stable")
        self._received_ns = received[order]
        self._newest = np.maximum.accumulate(stamps[order])

    def come(self, now_ns: int) -> None:
        """What was received up to now has come.

        Args:
            now_ns: [ns, the recorder's clock].
        """
        for topic, times in self.arrivals.items():
            first, last = self._done.get(topic, 0), int(np.searchsorted(times[:, 0], now_ns, side="right"))
            for received, stamp in times[first:last].tolist():
                self.clock.hear(topic, received, stamp)
            self._done[topic] = max(first, last)

    def findings(self, now_ns: int) -> list[Finding]:
        """What is odd about the topics' clocks; none of it stops.

        Args:
            now_ns: [ns, the recorder's clock].
        """
        return [
            Finding("clock", (), text, False)
            for topic, estimate in self.clock.estimates(now_ns).items()
            if (text := joint_clock_text(topic, estimate)) is not None
        ]

    def at(self, frames: Sequence[DepthFrame], now_ns: int) -> Where:
        """Where the machine is, and was when frames were taken.

        Args:
            frames: with the times of their exposure [ns, the room's clock].
            now_ns: [ns, the recorder's clock].

        Raises:
            JointsError: nothing has come yet, or for longer than the record may have gaps.
        """
        last_ns, later_ns, most_ns = self._newest_ns(now_ns), self._later_ns(now_ns), self.record.max_gap_ns
        if last_ns is None:
            raise JointsError("joints: where the machine is, is not known: nothing was said yet")
        said_ns = last_ns + later_ns
        if most_ns is not None and now_ns - said_ns > most_ns:
            raise JointsError(
                "joints: where the machine is, is not known: nothing was said for "
                f"{length_text(now_ns - said_ns)}"
            )
        at_frame = {
            frame.camera: self.record.at(min((frame.stamp_ns or 0) - later_ns, last_ns)) for frame in frames
        }
        return Where(self.record.at(last_ns), at_frame, self.record.velocities_at(last_ns), said_ns)

    def said_ns(self, now_ns: int) -> int | None:
        """When the newest row that had come was so [ns, the room's clock]; None: none had.

        Args:
            now_ns: [ns, the recorder's clock].
        """
        last_ns = self._newest_ns(now_ns)
        return None if last_ns is None else last_ns + self._later_ns(now_ns)

    def _newest_ns(self, now_ns: int) -> int | None:
        """The stamp of the newest row that had come [ns]; None: none had."""
        come = int(np.searchsorted(self._received_ns, now_ns, side="right"))
        return int(self._newest[come - 1]) if come else None

    def _later_ns(self, now_ns: int) -> int:
        """What is added to stamps, at most 0, so that no row comes before it was [ns]; of several topics the least."""
        estimates = self.clock.estimates(now_ns).values()
        return min((estimate.offset_ns for estimate in estimates if estimate.offset_ns < 0), default=0)
