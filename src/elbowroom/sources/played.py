"""A bag as if it came from cameras now: it goes on by itself, and whoever asks gets the newest frame of each camera."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from elbowroom.errors import JointsError
from elbowroom.finding import Finding
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot
from elbowroom.site.recording_entry import BagRecording
from elbowroom.site.site import Site
from elbowroom.sources.layouts.bag import BagFrames
from elbowroom.sources.layouts.bag_image import Arrival
from elbowroom.sources.newest import Newest
from elbowroom.sources.recorded import Joints, require_joints
from elbowroom.sources.room_clock import RoomClock
from elbowroom.sources.times.clock import ClockEstimate
from elbowroom.sources.times.series import length_text

IDLE_NS = 200_000_000
"""Where nothing comes for so long, what there is comes again: it grows old [ns]."""
BEGIN_NS = 1_000_000_000
"""For so long at most all cameras are awaited at the beginning [ns]."""


@dataclass(slots=True, eq=False)
class Played:
    """The bag of a site as a source that does not wait. Its clock is the recorder's.

    Args:
        site: with a recording of layout `bag`.
        joints: positions that hold throughout, or a record; None: the bag's own.
        gap_ns: where nothing was recorded for longer, that is skipped [ns].
        clock_ns, sleep: of this computer [ns], [s].
    """

    site: Site
    joints: Joints | None = None
    gap_ns: int = 5_000_000_000
    clock_ns: Callable[[], int] = time.perf_counter_ns
    sleep: Callable[[float], None] = time.sleep
    findings: tuple[Finding, ...] = field(default=(), init=False)
    """What was odd about the snapshot that came last."""
    clocks: Mapping[str, ClockEstimate] = field(default_factory=dict, init=False)
    """What is known of the cameras' clocks."""

    @property
    def name(self) -> str:
        """What its time is spent on."""
        return "playing"

    def __iter__(self) -> Iterator[Snapshot]:
        """Snapshots from when every camera has given something, or a second after the first.

        Raises:
            SiteError, BagError, FrameError, JointsError: as `BagFrames`, at the beginning; what is damaged later is
                left out, and said.
        """
        recording = self.site.entry.recording
        assert isinstance(recording, BagRecording)
        layout = BagFrames(self.site, recording, self.site.recording_folder())
        arrivals, joints = layout.arrivals(), self.joints if self.joints is not None else layout.joints()
        if not arrivals:
            layout.moments()  # says that there are none
        require_joints(self.site, joints)
        stampless = frozenset(c.name for c in self.site.cameras() if not layout.by_header(c.name))
        max_skew_ns = round(recording.max_skew_ms * 1e6)
        return self._snapshots(arrivals, Newest(RoomClock(stampless), max_skew_ns), joints)

    def close(self) -> None:
        """Nothing is held between two snapshots."""

    def _snapshots(
        self, arrivals: Sequence[Arrival], frames: Newest, joints: Joints | None
    ) -> Iterator[Snapshot]:
        done, begin_ns, start_ns = 0, _begin_ns(arrivals), self.clock_ns()
        while done < len(arrivals):
            now_ns = begin_ns + self.clock_ns() - start_ns
            wait_ns = arrivals[done].received_ns - now_ns
            if done and wait_ns > self.gap_ns:
                begin_ns, wait_ns = begin_ns + wait_ns, 0
                now_ns = arrivals[done].received_ns
            if wait_ns > 0:
                self.sleep(min(wait_ns, IDLE_NS) / 1e9)
                if wait_ns <= IDLE_NS:
                    continue
                now_ns = begin_ns + self.clock_ns() - start_ns
            first = done
            while done < len(arrivals) and arrivals[done].received_ns <= now_ns:
                done += 1
            frames.come(arrivals[first:done])
            yield self._snapshot(frames, now_ns, joints)

    def _snapshot(self, frames: Newest, now_ns: int, joints: Joints | None) -> Snapshot:
        newest, found = frames.at(now_ns)
        taken = tuple(one.frame for one in newest)
        bounds = {one.frame.camera: one.bound_ns for one in newest}
        self.clocks = frames.clock.estimates(now_ns)
        found = [*frames.clock.findings(now_ns), *found]
        now_at: Mapping[str, float] | None = None
        at_frame: Mapping[str, Mapping[str, float]] = {}
        speeds: Mapping[str, float] = {}
        try:
            now_at, at_frame, speeds = _joints_of(joints, taken, now_ns)
        except JointsError as error:
            found.append(Finding("joints", (), str(error), True))
        self.findings = tuple(found)
        said_ns = _said_ns(joints, now_ns)
        return Snapshot(taken, now_at, at_frame, now_ns, bounds, said_ns, velocities=speeds)


def _joints_of(
    joints: Joints | None, frames: Sequence[DepthFrame], now_ns: int
) -> tuple[Mapping[str, float] | None, Mapping[str, Mapping[str, float]], Mapping[str, float]]:
    """Where the machine is by the last row before now, where it was at each frame's time, and how fast it is.

    Raises:
        JointsError: the record does not know it, or nothing has come for longer than it may have gaps.
    """
    if not isinstance(joints, JointRecord):
        return joints, {}, {}
    heard = int(np.searchsorted(joints.stamps_ns, now_ns, side="right"))
    last_ns = int(joints.stamps_ns[heard - 1]) if heard else None
    if last_ns is None or (joints.max_gap_ns is not None and now_ns - last_ns > joints.max_gap_ns):
        since = (
            "nothing was said yet"
            if last_ns is None
            else f"nothing was said for {length_text(now_ns - last_ns)}"
        )
        raise JointsError(f"joints: where the machine is, is not known: {since}")
    at_frame = {frame.camera: joints.at(min(frame.stamp_ns or 0, last_ns)) for frame in frames}
    return joints.at(last_ns), at_frame, joints.velocities_at(last_ns)


def _said_ns(joints: Joints | None, now_ns: int) -> int | None:
    """When the last row before now was so [ns]; None: there is no record, or none was."""
    if not isinstance(joints, JointRecord):
        return None
    heard = int(np.searchsorted(joints.stamps_ns, now_ns, side="right"))
    return int(joints.stamps_ns[heard - 1]) if heard else None


def _begin_ns(arrivals: Sequence[Arrival]) -> int:
    """When every camera that gives images has given one, or a second after the first."""
    first: dict[str, int] = {}
    for arrival in arrivals:
        first.setdefault(arrival.image.camera.name, arrival.received_ns)
    return min(max(first.values()), arrivals[0].received_ns + BEGIN_NS)
