"""All streams of a room: what is wrong with each source now, and what is left of a snapshot without the sick ones."""

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace

import numpy as np

from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.machine import Machine
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.health import Condition, Health
from elbowroom.monitor.health.streams.camera_stream import CLEARS as CAMERA_CLEARS
from elbowroom.monitor.health.streams.camera_stream import CameraStream, Moment
from elbowroom.monitor.health.streams.cause import HealthCause, Sick
from elbowroom.monitor.health.streams.joint_stream import CLEARS as JOINT_CLEARS
from elbowroom.monitor.health.streams.joint_stream import SOURCE, Heard, JointStream
from elbowroom.monitor.health.streams.thumb import Thumb
from elbowroom.sensing import Snapshot

CLOCKS, DAMAGED = ("clock", "order"), "damaged"
"""Kinds of findings that say what is wrong with a camera's stamps, and with its newest image."""


@dataclass(frozen=True, slots=True)
class Ways:
    """How the sources of a room are to be heard.

    Args:
        max_age_ns: images that are older are too old [ns]; None: the site sets no limit.
        repeating: cameras that are exact, so that equal images say nothing.
        tolerated: causes, by their word, without whose camera the machine may go on.
        greatest: by joint, its greatest speed [m/s or rad/s].
    """

    max_age_ns: int | None = None
    repeating: frozenset[str] = frozenset()
    tolerated: frozenset[str] = frozenset()
    greatest: Mapping[str, float] = field(default_factory=dict)


class Streams:
    """Hears each snapshot. A cause that it found is there until its own evidence says that it is over.

    Args:
        cameras: all of the room.
        machine: whose joints are heard; None: there is none.
        ways: how to hear them.
        references: what cameras were commissioned on; of others the first good moments count.
        clock_ns: of this computer; it never goes back [ns].
    """

    def __init__(
        self,
        cameras: Sequence[DepthCamera],
        machine: Machine | None = None,
        ways: Ways | None = None,
        references: Sequence[CameraReference] = (),
        clock_ns: Callable[[], int] = time.perf_counter_ns,
    ) -> None:
        self._ways, self._clock_ns = ways or Ways(), clock_ns
        spots = {reference.camera: _spots(reference) for reference in references}
        self._cameras = {
            camera.name: CameraStream(
                camera,
                camera.name in self._ways.repeating,
                self._ways.max_age_ns,
                spots.get(camera.name),
            )
            for camera in cameras
        }
        self._joints = None if machine is None else JointStream(machine, self._ways.greatest)
        self._now_ns: int | None = None
        self._health: Health | None = None
        self._since_heard, self._since_known = _Since(), _Since()

    def hear(self, snapshot: Snapshot, found: Sequence[Finding] = ()) -> tuple[Sick, ...]:
        """What is wrong now, cameras in the room's order, then joints.

        Args:
            snapshot: what came, all of it.
            found: what looks at times and the source itself found about it.
        """
        now_ns = snapshot.moment_ns
        went_ns = 0 if now_ns is None or self._now_ns is None else now_ns - self._now_ns
        self._now_ns = now_ns if now_ns is not None else self._now_ns
        if any(each.stops and each.kind == "clock" and not each.about for each in found):
            # the monitor's own clock is in doubt: that is said, and nothing can be told of others by it
            went_ns, snapshot, found = 0, replace(snapshot, now_ns=None, joints_ns=None), ()
        frames = {frame.camera: frame for frame in snapshot.frames}
        good = {name: each.good for name, each in self._cameras.items() if each.good is not None}
        for name, stream in self._cameras.items():
            moment = Moment(
                went_ns,
                snapshot.now_ns,
                snapshot.clock_bounds_ns.get(name, 0),
                _about(found, name, CLOCKS),
                _about(found, name, (DAMAGED,)),
            )
            stream.hear(frames.get(name), moment, good)
        if self._joints is not None:
            self._joints.hear(_heard(snapshot, went_ns, self._health))
        return self._since_heard.lasting(self._sick(), self._clock_ns())

    def knowing(self, sick: Sequence[Sick], health: Health) -> tuple[Sick, ...]:
        """The same with cameras that the watch found elsewhere, or doubts; joints are heard with it at the next pass.

        Args:
            sick: what is wrong otherwise.
            health: what the watch says of this pass.
        """
        self._health = health
        swapped = {each.source for each in sick if each.cause is HealthCause.CAMERA_SWAPPED}
        elsewhere = (self._tolerated(each) for each in _elsewhere(health, swapped))
        return (*sick, *self._since_known.lasting(elsewhere, self._clock_ns()))

    def usable(self, snapshot: Snapshot) -> Snapshot:
        """What can be looked at: images of the right size, and joints where the machine can be."""
        frames = tuple(
            frame
            for frame in snapshot.frames
            if frame.camera not in self._cameras or self._cameras[frame.camera].is_usable
        )
        if self.joints_usable:
            return replace(snapshot, frames=frames)
        return replace(snapshot, frames=frames, joints=None, joints_of={})

    def blind(self, sick: Sequence[Sick]) -> str | None:
        """That no camera gives anything that counts, one sentence; None: one does.

        Args:
            sick: what is wrong.
        """
        out = {each.source for each in sick if each.leaves_out}
        if not out.issuperset(self._cameras):
            return None
        awaited = [each.source for each in sick if each.cause is HealthCause.CAMERA_STARTING]
        named = f"; awaited: {', '.join(awaited)}" if awaited else ""
        return f"no camera gives anything that counts{named}"

    @property
    def joints_usable(self) -> bool:
        """Whether the machine can be where it is said to be."""
        return self._joints is None or self._joints.is_usable

    def _sick(self) -> Iterator[Sick]:
        for name, camera in self._cameras.items():
            for cause in camera.causes:
                text = f"camera {name} {camera.texts[cause]}"
                yield self._tolerated(Sick(cause, name, text, CAMERA_CLEARS[cause]))
        if self._joints is not None:
            for cause in self._joints.causes:
                yield Sick(cause, SOURCE, f"joints: {self._joints.texts[cause]}", JOINT_CLEARS[cause])

    def _tolerated(self, sick: Sick) -> Sick:
        """The same, if the site says so without a latch."""
        return replace(sick, tolerated=sick.cause.word in self._ways.tolerated)


@dataclass(slots=True, eq=False)
class _Since:
    """Since when each cause is there, by this computer's clock."""

    _since_ns: dict[tuple[HealthCause, str], int] = field(default_factory=dict)

    def lasting(self, sick: Iterable[Sick], now_ns: int) -> tuple[Sick, ...]:
        """The same with how long each has been there; those that are not among them are over.

        Args:
            sick: all that is wrong now.
            now_ns: the time [ns].
        """
        before, self._since_ns = self._since_ns, {}
        told = []
        for each in sick:
            of = each.cause, each.source
            self._since_ns[of] = before.get(of, now_ns)
            told.append(replace(each, lasts_s=(now_ns - self._since_ns[of]) / 1e9))
        return tuple(told)


def without_sick(snapshot: Snapshot, sick: Sequence[Sick]) -> Snapshot:
    """The same moment without the frames of sick cameras: they are missing.

    Args:
        snapshot: what came.
        sick: what is wrong.
    """
    out = {each.source for each in sick if each.leaves_out}
    if not out:
        return snapshot
    return replace(snapshot, frames=tuple(frame for frame in snapshot.frames if frame.camera not in out))


def _heard(snapshot: Snapshot, went_ns: int, health: Health | None) -> Heard:
    is_off = health is not None and any(link.is_off for link in health.links)
    return Heard(snapshot.joints, snapshot.joints_ns, went_ns, snapshot.commanded, is_off)


def _about(found: Sequence[Finding], camera: str, kinds: Sequence[str]) -> str | None:
    """What was found of some kinds about a camera that stops, or that leaves it out; None: nothing."""
    texts = [
        each.text.removeprefix(f"camera {camera} ")
        for each in found
        if each.kind in kinds and each.about == (camera,) and (each.stops or each.kind == DAMAGED)
    ]
    return texts[0] if texts else None


def _elsewhere(health: Health, swapped: Set[str]) -> Iterator[Sick]:
    """Cameras for which the watch stops since they are elsewhere, or that may be; of others all is said already.

    Args:
        health: what the watch says.
        swapped: cameras of which it is said already that they show what another one gave.
    """
    for camera in health.cameras:
        name, is_stopped = camera.camera, camera.camera in health.stops
        if camera.shows is not None:
            if name not in swapped:
                text = f"camera {name} shows what camera {camera.shows} was commissioned on, not its own: exchanged?"
                yield _sick(HealthCause.CAMERA_SWAPPED, name, text)
        elif camera.doubt is not None and not is_stopped:
            yield _sick(HealthCause.CAMERA_DOUBTED, name, f"camera {name} {camera.doubt}")
        elif is_stopped and camera.condition in (Condition.MOVED, Condition.CHANGED):
            yield _sick(HealthCause.CAMERA_MOVED, name, health.stops[name])


def _sick(cause: HealthCause, camera: str, text: str) -> Sick:
    return Sick(cause, camera, text, CAMERA_CLEARS[cause])


def _spots(reference: CameraReference) -> Thumb:
    """What a camera was commissioned on as a small image, 0 between the spots."""
    step = Thumb.of(np.empty((1, reference.width), dtype=np.float32)).step
    rows, columns = -(-reference.height // step), -(-reference.width // step)
    depth_m = np.zeros((rows, columns), dtype=np.float32)
    v, u = reference.pixel // reference.width, reference.pixel % reference.width
    depth_m[v // step, u // step] = reference.depth_m
    return Thumb(depth_m, step)
