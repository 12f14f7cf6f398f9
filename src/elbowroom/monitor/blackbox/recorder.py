"""The face that keeps what a run was given and what it decided; it never makes the run wait, and never stops it."""

import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from elbowroom.errors import InputError
from elbowroom.finding import Finding
from elbowroom.monitor.blackbox.configuration import Configuration, plain_cycle
from elbowroom.monitor.blackbox.kept_pass import Keeping, Moment, still_messages
from elbowroom.monitor.blackbox.pass_file import Head
from elbowroom.monitor.blackbox.sinks import Sink
from elbowroom.monitor.blackbox.stops import Stops
from elbowroom.monitor.cycle import Cycle
from elbowroom.monitor.face import Pass
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources import Room
from elbowroom.wire.depth_codec import Units, warm_up

MOST_BYTES = 256_000_000
"""So much of images may wait to be packed; a pass that comes then is lost, and that is told [bytes]."""
ENDS_S = 120.0
"""For so long the end of a run waits for what is left to write [s]."""
LISTENS_S = 0.2
"""While nothing comes it looks so often for what is left to do [s]."""


@dataclass(slots=True, eq=False)
class Recorder:
    """Hands passes to a thread of its own, which packs them and hands them on.

    Besides a face it is a look (`monitor.health`): while something is not kept, each pass says so, which stops nothing.

    Args:
        sinks: where passes go.
        most_bytes: of images that wait.
        cycle: that judges; None: as its room says.

    Raises:
        PackageError: zstandard is not installed.
    """

    sinks: Sequence[Sink]
    most_bytes: int = MOST_BYTES
    cycle: Cycle | SpaceCycle | None = None
    name: str = field(default="recording", init=False)
    lost: int = field(default=0, init=False)
    busy_ns: int = field(default=0, init=False)
    """Processor time that its thread and those of its sinks have taken [ns]."""
    _queue: deque[tuple[Moment, int]] = field(default_factory=deque, init=False)
    _waits: threading.Condition = field(default_factory=threading.Condition, init=False)
    _bytes: int = field(default=0, init=False)
    _lost_since: int = field(default=0, init=False)
    _newest: dict[str, DepthFrame] = field(default_factory=dict, init=False)
    _is_over: bool = field(default=False, init=False)
    _fault: str | None = field(default=None, init=False)
    _keeping: Keeping = field(default_factory=lambda: Keeping({}), init=False)
    _stops: Stops = field(default_factory=Stops, init=False)
    _thread: threading.Thread | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        warm_up()

    def begin(self, room: Room) -> None:
        """Begins the files, and the thread.

        Raises:
            InputError: a file cannot be written.
        """
        site, names = room.site, [camera.name for camera in room.cameras]
        units = {name: Units(site.depth_scale_m(name), site.depth_bias_m(name)) for name in names}
        radial = frozenset(camera.name for camera in room.cameras if camera.depth_kind == "radial")
        self._keeping = Keeping(units, radial)
        configuration = Configuration.of(room, self.cycle or plain_cycle(room))
        head = Head(configuration.attached(), still_messages(room.cameras))
        for sink in self.sinks:
            try:
                sink.begin(head)
            except OSError as error:
                raise InputError(f"{error.filename}: cannot be written ({error.strerror})") from None
        self._thread = threading.Thread(target=self._keep, name="recorder", daemon=True)
        self._thread.start()

    def show(self, done: Pass) -> None:
        """Hands on a pass, if there is room; else it is lost. It does not wait."""
        new = [f for f in done.snapshot.frames if self._newest.get(f.camera) is not f]
        size = sum(frame.depth_m.nbytes for frame in new)
        with self._waits:
            if self._queue and self._bytes + size > self.most_bytes:
                self.lost += 1
                self._lost_since += 1
                return
            self._newest |= {frame.camera: frame for frame in new}
            self._bytes += size
            moment = Moment(done, time.monotonic_ns(), time.time_ns(), self._lost_since)
            self._queue.append((moment, size))
            self._lost_since = 0
            self._waits.notify()

    def hear(self, snapshot: Snapshot) -> Sequence[Finding]:
        """What is not kept."""
        return [Finding("recording", (), text, False) for text in self.troubles]

    @property
    def troubles(self) -> list[str]:
        """What is not kept, a line each."""
        found = [sink.trouble for sink in self.sinks if sink.trouble is not None]
        if self._fault is not None:
            found.append(f"recording: {self._fault}")
        if self.lost:
            found.append(f"recording: {self.lost} passes were not kept, since disk or processor are too slow")
        return found

    @property
    def said(self) -> list[str]:
        """What was written, a line each."""
        return [line for sink in self.sinks for line in sink.said]

    def end(self) -> None:
        """Waits until all that was handed on is kept; where a disk does not answer, not for ever."""
        with self._waits:
            self._is_over = True
            self._waits.notify()
        if self._thread is not None:
            self._thread.join(ENDS_S)
            if self._thread.is_alive():
                self._fault = f"the disk does not answer for {ENDS_S:g} s; what waits is not kept"

    def _keep(self) -> None:
        """What the thread does."""
        is_idle = False
        while True:
            moment = self._next(is_idle)
            if moment is None and is_idle and self._is_over:
                break
            is_done = self._guarded(self._take, moment)
            is_idle = moment is None and not is_done
            self.busy_ns = self._spent_ns()
        for sink in self.sinks:
            self._guarded(partial(_end, sink), None)
        self.busy_ns = self._spent_ns()

    def _spent_ns(self) -> int:
        return time.thread_time_ns() + sum(sink.busy_ns for sink in self.sinks)

    def _take(self, moment: Moment | None) -> bool:
        """Keeps a pass; without one, does a little of what is left to do. Whether something was done."""
        if moment is None:
            return sum(sink.work() for sink in self.sinks) > 0  # each of them
        kept = self._keeping.of(moment, self._stops.hear(moment.done))
        for sink in self.sinks:
            sink.take(kept)
        return True

    def _guarded(self, what: Callable[[Moment | None], object], moment: Moment | None) -> bool:
        """Does it, and whether it came to something; whatever fails here, the run goes on."""
        try:
            return bool(what(moment))
        except Exception as error:
            self._fault = f"{type(error).__name__}: {error}"
            return False

    def _next(self, waits: bool) -> Moment | None:
        """The pass that came first; None: none is there.

        Args:
            waits: whether there is nothing else to do.
        """
        with self._waits:
            if waits and not self._queue and not self._is_over:
                self._waits.wait(LISTENS_S)
            if not self._queue:
                return None
            moment, size = self._queue.popleft()
            self._bytes -= size
            return moment


def _end(sink: Sink, _: Moment | None) -> None:
    sink.end()


def require_new(path: Path) -> Path:
    """A path at which a file can be begun.

    Raises:
        InputError: it is there already, or its folder is not there.
    """
    if path.exists():
        raise InputError(f"{path}: is there already; a recording is never written over, name another file")
    if not path.parent.is_dir():
        raise InputError(f"{path}: cannot be written; name a folder that exists")
    return path
