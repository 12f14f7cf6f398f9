"""The room for faults as a source that goes on by itself, at 15 Hz a camera, and what a fault makes of it."""

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from elbowroom.evaluate.faults.scene import at_s, image_of
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame, Snapshot

TICK_S = 1 / 30
"""Cameras give an image at each second tick, one half of them at the odd ones."""


class Wrong(Protocol):
    """What a fault changes; the rest is as it is."""

    def camera(self, camera: DepthCamera) -> DepthCamera:
        """Where a camera truly is."""

    def frame(self, frame: DepthFrame, live: "Live") -> DepthFrame | None:
        """What becomes of a new image; None: it does not come."""

    def snapshot(self, snapshot: Snapshot, live: "Live") -> Snapshot:
        """What becomes of what is handed out."""


class Live:
    """The source. Faults begin and end while it goes on.

    Args:
        cameras: where they are said to be.
    """

    name = "live"

    def __init__(self, cameras: tuple[DepthCamera, ...]) -> None:
        self.cameras = cameras
        self.newest: dict[str, DepthFrame] = {}
        self.ahead_ns = 0
        """By how much the program's clock was set ahead."""
        self.shows_ns: int | None = None
        """When the first thing that is wrong was handed out [ns of `time.monotonic_ns`]; None: nothing was."""
        self.on_shown: Callable[[int], None] = lambda at_ns: None
        self._wrong: Wrong | None = None
        self._hang_s = 0.0
        self._lock = threading.Lock()
        self._random = np.random.default_rng()

    def begin(self, wrong: Wrong) -> None:
        """A fault begins."""
        with self._lock:
            self._wrong, self.shows_ns = wrong, None

    def end(self) -> None:
        """All is well from now on."""
        with self._lock:
            self._wrong = None

    def hang(self, seconds: float) -> None:
        """The next snapshot is so late."""
        with self._lock:
            self._hang_s, self.shows_ns = seconds, None

    def clock_ns(self) -> int:
        """The time by the program's clock [ns]."""
        return time.monotonic_ns() + self.ahead_ns

    def __iter__(self) -> Iterator[Snapshot]:
        """Snapshots without end."""
        self.newest = {}
        begun_s, tick = time.monotonic(), 0
        while True:
            late_s = time.monotonic() - begun_s - tick * TICK_S
            if late_s < 0:
                time.sleep(-late_s)
            elif late_s > 1.0:
                begun_s += late_s  # this computer stalled: what was missed does not come in a burst
            if self._hang_s:
                self._shown()
                time.sleep(self._hang_s)
                self._hang_s = 0.0
            with self._lock:
                snapshot = self._snapshot(tick, self._wrong)
            yield snapshot
            tick += 1

    def close(self) -> None:
        """Nothing is held."""

    def _snapshot(self, tick: int, wrong: Wrong | None) -> Snapshot:
        now_ns = self.clock_ns()
        slide_m, speed_m_s = at_s(time.monotonic())
        changed = False
        for number, camera in enumerate(self.cameras):
            if (tick + number) % 2:
                continue
            true = camera if wrong is None else wrong.camera(camera)
            came = frame = DepthFrame(camera.name, now_ns, image_of(true, slide_m, self._random))
            if wrong is not None:
                came = wrong.frame(frame, self) or self.newest.get(camera.name) or frame
            changed |= came is not frame or true is not camera
            self.newest[camera.name] = came
        sound = Snapshot(
            tuple(self.newest.values()),
            {"slide": slide_m},
            now_ns=now_ns,
            joints_ns=now_ns,
            commanded={"slide": speed_m_s},
        )
        given = sound if wrong is None else wrong.snapshot(sound, self)
        if (changed or given is not sound) and self.shows_ns is None:
            self._shown()
        return given

    def _shown(self) -> None:
        self.shows_ns = time.monotonic_ns()
        self.on_shown(self.shows_ns)


@dataclass
class Nothing:
    """A fault that changes nothing; others change one thing."""

    def camera(self, camera: DepthCamera) -> DepthCamera:
        """As it is."""
        return camera

    def frame(self, frame: DepthFrame, live: Live) -> DepthFrame | None:
        """As it is."""
        return frame

    def snapshot(self, snapshot: Snapshot, live: Live) -> Snapshot:
        """As it is."""
        return snapshot


Image = Callable[[DepthFrame, Live], DepthFrame | None]
Whole = Callable[[Snapshot, Live], Snapshot]


@dataclass
class OfImages(Nothing):
    """Changes the images of one camera.

    Args:
        of: its name.
        change: of each new image.
    """

    of: str
    change: Image

    def frame(self, frame: DepthFrame, live: Live) -> DepthFrame | None:
        """Changed, if it is that camera's."""
        return self.change(frame, live) if frame.camera == self.of else frame


@dataclass
class OfSnapshots(Nothing):
    """Changes what is handed out.

    Args:
        change: of each snapshot.
    """

    change: Whole

    def snapshot(self, snapshot: Snapshot, live: Live) -> Snapshot:
        """Changed."""
        return self.change(snapshot, live)


@dataclass
class OfPlace(Nothing):
    """A camera that was knocked.

    Args:
        of: its name.
        old_from_new: its new pose in its old axes, shape (4, 4).
    """

    of: str
    old_from_new: np.ndarray = field(repr=False)

    def camera(self, camera: DepthCamera) -> DepthCamera:
        """Elsewhere, if it is that camera."""
        if camera.name != self.of:
            return camera
        return replace(camera, world_from_camera=camera.world_from_camera @ self.old_from_new)
