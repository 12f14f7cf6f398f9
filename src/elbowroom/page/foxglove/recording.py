"""A recording for Foxglove: its controls play, pause and seek."""

import bisect
import queue
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.extras import package
from elbowroom.monitor.blackbox.configuration import Configuration
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.face import planes_of
from elbowroom.page.foxglove.bridge import Bridge
from elbowroom.page.replay.again import Judge

LISTENS_S = 0.02
LONGEST_STEP_S = 1.0
"""Where a recording has a gap, play goes on after so long [s]."""
SPEEDS = (0.01, 100.0)


@dataclass(slots=True, eq=False)
class PlayedBridge:
    """Plays a recording to viewers.

    Args:
        recording: the file.
        configuration: of it.
        port: at which; 0: any that is free.

    Raises:
        InputError: the port is taken.
        PackageError: foxglove-sdk is missing.
    """

    recording: Recording
    configuration: Configuration
    port: int
    bridge: Bridge = field(init=False)
    index: int = field(default=0, init=False)
    is_playing: bool = field(default=False, init=False)
    speed: float = field(default=1.0, init=False)
    _judge: Judge = field(init=False)
    _times_ns: list[int] = field(init=False)
    _requests: "queue.Queue[Any]" = field(default_factory=lambda: queue.Queue(64), init=False)

    def __post_init__(self) -> None:
        self._judge = Judge(self.recording, self.configuration)
        count = len(self.recording)
        self._times_ns = [int(self.recording.said_at(number)["wall_ns"]) for number in range(count)]
        span = (self._times_ns[0], max(self._times_ns[-1], self._times_ns[0] + 1))
        self.bridge = Bridge(self.configuration, self.port, self, span)

    def asked(self, request: Any) -> Any:
        """A viewer plays, pauses or seeks, in the server's thread; what is answered at once.

        Args:
            request: of Foxglove's protocol.
        """
        try:
            self._requests.put_nowait(request)
        except queue.Full:
            return None
        now_ns = self._times_ns[self.index] if request.seek_time is None else int(request.seek_time)
        return self._state(now_ns, _plays(request), request.seek_time is not None, request.request_id)

    def run(self, is_over: Callable[[], bool], begin: int = 0) -> None:
        """Shows what is asked for, until it is over.

        Args:
            is_over: whether to end.
            begin: number of the first pass in the file.
        """
        self._show(begin)
        due_s = time.monotonic()
        while not is_over():
            if self._hear():
                due_s = time.monotonic() + self._step_s()
            if self.is_playing and time.monotonic() >= due_s:
                if self.index + 1 >= len(self._times_ns):
                    self._end()
                    continue
                self._show(self.index + 1)
                # not faster than passes can be judged again
                due_s = max(due_s, time.monotonic() - LONGEST_STEP_S) + self._step_s()

    def _hear(self) -> bool:
        """Does what was asked for last; whether anything was."""
        try:
            request = self._requests.get(timeout=LISTENS_S)
        except queue.Empty:
            return False
        self.is_playing = _plays(request)
        low, high = SPEEDS
        self.speed = min(max(float(request.playback_speed) or 1.0, low), high)
        if request.seek_time is not None:
            found = bisect.bisect_right(self._times_ns, int(request.seek_time)) - 1
            self._show(min(max(found, 0), len(self._times_ns) - 1))
        elif self.is_playing and self.index + 1 >= len(self._times_ns):
            self._show(0)
        return True

    def _step_s(self) -> float:
        """How long the pass that is shown stays [s]."""
        if self.index + 1 >= len(self._times_ns):
            return 0.0
        step_s = (self._times_ns[self.index + 1] - self._times_ns[self.index]) / 1e9
        return min(max(step_s, 0.0), LONGEST_STEP_S) / self.speed

    def _end(self) -> None:
        self.is_playing = False
        status = package("foxglove.websocket").PlaybackStatus.Ended
        self.bridge.playing(self._state(self._times_ns[self.index], False, False, None, status))

    def _show(self, index: int) -> None:
        self.index = index
        try:
            told, one = self._judge.told(index)
            self.bridge.tell(told)
            if one.snapshot.frames and self.bridge.wanted_depth:
                self.bridge.show_images(told, one.snapshot)
            again = self._judge.again(told, one)
            if again.space is not None:
                self.bridge.show_space(told, planes_of(again.space))
        except ElbowroomError:
            self.is_playing = False  # what cannot be read is not shown

    def _state(
        self, now_ns: int, is_playing: bool, did_seek: bool, request: str | None, status: Any = None
    ) -> Any:
        made = package("foxglove.websocket")
        if status is None:
            status = made.PlaybackStatus.Playing if is_playing else made.PlaybackStatus.Paused
        return made.PlaybackState(
            status=status,
            current_time=now_ns,
            playback_speed=self.speed,
            did_seek=did_seek,
            request_id=request,
        )


def _plays(request: Any) -> bool:
    return bool(request.playback_command == package("foxglove.websocket").PlaybackCommand.Play)
