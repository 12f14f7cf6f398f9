"""The monitor's end of its watchdog: starts it, sends heartbeats, reads what it reports, says what is wrong with it."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from elbowroom.guard.fault import Fault
from elbowroom.guard.heartbeat import Heartbeat
from elbowroom.guard.reason import Reason

START_S = 10.0
"""So long a watchdog may take to be ready."""
AGAIN_NS = 1_000_000_000
"""After so long one that ended is started again [ns]."""
END_S = 1.0


@dataclass(slots=True, eq=False)
class WatchdogLink:
    """A watchdog, seen from the monitor. It does not raise and does not wait, but at the start.

    Args:
        told: the watchdog's configuration, see `watchdog`.
        clock_ns: the clock of the heartbeats [ns].
    """

    told: Mapping[str, Any]
    clock_ns: Callable[[], int] = time.monotonic_ns
    trips: int = field(default=0, init=False)
    outputs: tuple[str, ...] = field(default=(), init=False)
    _process: subprocess.Popen[bytes] | None = field(default=None, init=False)
    _received: bytes = field(default=b"", init=False)
    _unanswered: dict[int, int] = field(default_factory=dict, init=False)
    _is_ready: bool = field(default=False, init=False)
    _trouble: str | None = field(default=None, init=False)
    _started_ns: int = field(default=0, init=False)
    _has_tripped: bool = field(default=False, init=False)

    @property
    def process_id(self) -> int | None:
        """Of the watchdog; None: none runs."""
        return None if self._process is None else self._process.pid

    def begin(self) -> None:
        """Starts the watchdog, and waits until it is ready, or says that it cannot be, or `START_S` have gone by."""
        self._start()
        until_s = time.monotonic() + START_S
        while not self._is_ready and self._is_alive() and time.monotonic() < until_s:
            time.sleep(0.005)
            self._read()

    def send(self, heartbeat: Heartbeat) -> None:
        """Sends a heartbeat; if it cannot be, that is a fault of the watchdog."""
        if self._process is None or self._process.stdin is None:
            return
        packed = heartbeat.packed()
        try:
            sent = os.write(self._process.stdin.fileno(), packed)
        except OSError:
            sent = 0
        if sent != len(packed):
            self._kill()  # it reads no more, or half a heartbeat: what follows could not be told apart
            return
        self._unanswered[heartbeat.sequence] = self.clock_ns()

    def faults(self) -> list[Fault]:
        """What is wrong with the watchdog or its outputs, or was with the monitor as it saw it since the last call."""
        self._read()
        now_ns = self.clock_ns()
        found = []
        if self._has_tripped:
            found.append(Fault(Reason.SILENCE, "watchdog", "the watchdog heard of no finished pass in time"))
            self._has_tripped = False
        if not self._is_alive():
            found.append(Fault(Reason.WATCHDOG, "", self._trouble or "the watchdog has ended"))
            if now_ns - self._started_ns > AGAIN_NS:
                self._start()
        elif not self._is_ready:
            found.append(Fault(Reason.WATCHDOG, "", "the watchdog is starting"))
        elif now_ns - min(self._unanswered.values(), default=now_ns) > 2 * self.told["deadline_ns"]:
            found.append(Fault(Reason.WATCHDOG, "", "the watchdog does not answer"))
        elif self._trouble is not None:
            found.append(Fault(Reason.OUTPUT, "", self._trouble))
        return found

    def end(self) -> None:
        """Lets the watchdog end, or ends it."""
        process = self._process
        if process is None:
            return
        if process.stdin is not None:
            with suppress(OSError):
                process.stdin.close()
        try:
            process.wait(END_S)
        except subprocess.TimeoutExpired:
            process.kill()
        self._close()

    def _start(self) -> None:
        self._close()
        self._started_ns = self.clock_ns()
        self._received, self._unanswered = b"", {}
        self._is_ready, self._trouble, self.trips = False, None, 0
        words = [sys.executable, "-m", "elbowroom.guard.watchdog", json.dumps(dict(self.told))]
        try:
            self._process = subprocess.Popen(
                words,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                bufsize=0,
                start_new_session=True,  # what ends the monitor's group does not end it
            )
        except OSError as error:
            self._trouble = f"the watchdog cannot be started ({error.strerror})"
            return
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                os.set_blocking(pipe.fileno(), False)

    def _is_alive(self) -> bool:
        return self._process is not None and self._process.poll() is None

    def _read(self) -> None:
        """Takes in what was reported."""
        if self._process is None or self._process.stdout is None:
            return
        with suppress(OSError):
            while data := os.read(self._process.stdout.fileno(), 65536):
                self._received += data
        *lines, self._received = self._received.split(b"\n")
        for line in lines:
            with suppress(ValueError):
                self._take(json.loads(line))

    def _take(self, report: Mapping[str, Any]) -> None:
        if "ready" in report:
            self._is_ready, self.outputs = True, tuple(report["ready"])
        if "ack" in report:
            self._unanswered = {n: at for n, at in self._unanswered.items() if n > report["ack"]}
        if "trip" in report:
            self.trips, self._has_tripped = report["trip"], True
        if "trouble" in report:
            self._trouble = report["trouble"]
        if "well" in report:
            self._trouble = None

    def _kill(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    def _close(self) -> None:
        """Lets go of a process that has ended, or ends it."""
        if self._process is None:
            return
        if self._process.poll() is None:
            self._kill()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._process.wait()
        self._process = None
