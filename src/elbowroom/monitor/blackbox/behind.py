"""A file that is written by a thread of its own, so that a disk that stalls for seconds holds up nobody who packs."""

import threading
import time
from collections import deque
from pathlib import Path

from elbowroom.monitor.blackbox.kept_pass import KeptPass
from elbowroom.monitor.blackbox.pass_file import Head, PassFile

MOST_BYTES = 512_000_000
"""So much that is packed may wait for the disk: 7 s of 21 noisy cameras of 640x480 at 15 Hz [bytes]."""


class BehindFile:
    """Adds passes to a file, in the order in which they come.

    Args:
        path, head: as of `PassFile`.
        most_bytes: of packed passes that wait; who adds another waits until there is room.

    Raises:
        OSError: it cannot be written. What goes wrong behind is raised at the next call.
    """

    def __init__(self, path: Path, head: Head, most_bytes: int = MOST_BYTES) -> None:
        self._file, self._most_bytes = PassFile(path, head), most_bytes
        self._queue = deque[tuple[KeptPass, int]]()
        self._bytes = 0
        self._newest: dict[str, int] = {}
        self._waits = threading.Condition()
        self._is_over = False
        self._error: OSError | None = None
        self.busy_ns = 0
        """Processor time that its thread has taken [ns]."""
        self._thread = threading.Thread(target=self._write, name="recorder file", daemon=True)
        self._thread.start()

    @property
    def path(self) -> Path:
        """Of the file."""
        return self._file.path

    @property
    def passes(self) -> int:
        """How many are written."""
        return self._file.passes

    def add(self, one: KeptPass) -> None:
        """Hands on a pass."""
        new = [frame for frame in one.frames if self._newest.get(frame.camera) != frame.number]
        size = one.own_size + sum(len(frame.told.data) for frame in new)
        with self._waits:
            while self._queue and self._bytes + size > self._most_bytes and self._error is None:
                self._waits.wait()
            self.check()
            self._newest |= {frame.camera: frame.number for frame in new}
            self._bytes += size
            self._queue.append((one, size))
            self._waits.notify_all()

    def check(self) -> None:
        """Raises what went wrong behind, if anything did."""
        if self._error is not None:
            raise self._error

    def end(self) -> str:
        """Waits until all is written, and ends the file; what is said of it."""
        with self._waits:
            self._is_over = True
            self._waits.notify_all()
        self._thread.join()
        self.check()
        return self._file.end()

    def _write(self) -> None:
        """What the thread does."""
        while True:
            with self._waits:
                while not self._queue and not self._is_over:
                    self._waits.wait()
                if not self._queue:
                    return
                one, size = self._queue[0]  # it counts until it is written
            try:
                self._file.add(one)
            except OSError as error:
                with self._waits:
                    self._error = error
                    self._queue.clear()
                    self._waits.notify_all()
                return
            self.busy_ns = time.thread_time_ns()
            with self._waits:
                self._queue.popleft()
                self._bytes -= size
                self._waits.notify_all()
