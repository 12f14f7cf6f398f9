"""A bag as if it came from cameras now: it goes on by itself, and whoever asks gets the newest frame of each camera."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from elbowroom.errors import JointsError
from elbowroom.finding import Finding
from elbowroom.sensing import JointRecord, Snapshot
from elbowroom.site.recording_entry import BagRecording
from elbowroom.site.site import Site
from elbowroom.sources.cadence import Cadence
from elbowroom.sources.layouts.bag import BagFrames
from elbowroom.sources.layouts.bag_image import Arrival
from elbowroom.sources.newest import Newest
from elbowroom.sources.played_joints import PlayedJoints
from elbowroom.sources.recorded import Joints, require_joints
from elbowroom.sources.room_clock import RoomClock
from elbowroom.sources.times.clock import ClockEstimate

IDLE_NS = 200_000_000
"""Where nothing comes for so long, what there is comes again: it grows old [ns]."""
BEGIN_NS = 1_000_000_000
"""For so long at most all cameras are awaited at the beginning [ns]."""
Told = PlayedJoints | Mapping[str, float] | None
"""Where the machine is: as it is said, or positions that hold throughout [m or rad]; None: there is none."""


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
        told = PlayedJoints(joints, layout.joint_arrivals) if isinstance(joints, JointRecord) else joints
        return self._snapshots(arrivals, Newest(RoomClock(stampless), max_skew_ns), told)

    def close(self) -> None:
        """Nothing is held between two snapshots."""

    def _snapshots(self, arrivals: Sequence[Arrival], frames: Newest, joints: Told) -> Iterator[Snapshot]:
        done, begin_ns, start_ns = 0, _begin_ns(arrivals), self.clock_ns()
        cadence, asked_ns = Cadence(), None  # since when there are images that were not given yet
        while done < len(arrivals) or asked_ns is not None:
            now_ns = begin_ns + self.clock_ns() - start_ns
            next_ns = arrivals[done].received_ns if done < len(arrivals) else None
            if done and asked_ns is None and next_ns is not None and next_ns - now_ns > self.gap_ns:
                begin_ns, now_ns = begin_ns + next_ns - now_ns, next_ns
            first = done
            while done < len(arrivals) and arrivals[done].received_ns <= now_ns:
                cadence.come(arrivals[done].image.camera.name, arrivals[done].received_ns)
                done += 1
            frames.come(arrivals[first:done])
            if done > first and asked_ns is None:
                asked_ns = now_ns
            wait_ns = arrivals[done].received_ns - now_ns if done < len(arrivals) else 0
            if asked_ns is not None:
                # images that are due soon make the others worth nothing
                wait_ns = min(wait_ns, cadence.worth_until_ns(now_ns, asked_ns) - now_ns)
            if wait_ns > 0:
                self.sleep(min(wait_ns, IDLE_NS) / 1e9)
                if asked_ns is not None or wait_ns <= IDLE_NS:
                    continue
                now_ns = begin_ns + self.clock_ns() - start_ns
            asked_ns = None
            yield self._snapshot(frames, now_ns, joints)

    def _snapshot(self, frames: Newest, now_ns: int, joints: Told) -> Snapshot:
        newest, found = frames.at(now_ns)
        taken = tuple(one.frame for one in newest)
        bounds = {one.frame.camera: one.bound_ns for one in newest}
        self.clocks = frames.clock.estimates(now_ns)
        found = [*frames.clock.findings(now_ns), *found]
        if not isinstance(joints, PlayedJoints):
            self.findings = tuple(found)
            return Snapshot(taken, joints, {}, now_ns, bounds)
        joints.come(now_ns)
        found += joints.findings(now_ns)
        try:
            where = joints.at(taken, now_ns)
        except JointsError as error:
            self.findings = (*found, Finding("joints", (), str(error), True))
            return Snapshot(taken, None, {}, now_ns, bounds, joints.said_ns(now_ns))
        self.findings = tuple(found)
        return Snapshot(
            taken, where.now_at, where.at_frame, now_ns, bounds, where.said_ns, velocities=where.velocities
        )


def _begin_ns(arrivals: Sequence[Arrival]) -> int:
    """When every camera that gives images has given one, or a second after the first."""
    first: dict[str, int] = {}
    for arrival in arrivals:
        first.setdefault(arrival.image.camera.name, arrival.received_ns)
    return min(max(first.values()), arrivals[0].received_ns + BEGIN_NS)
