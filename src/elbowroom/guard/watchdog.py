"""The watchdog's process: heartbeats come in on its standard input, and outputs say stop where they do not.

    python -m elbowroom.guard.watchdog CONFIG

CONFIG is JSON: `motions` (names), `deadline_ns`, `callback`, `modbus`, see `output.outputs_of`. On its standard output
it reports, a line of JSON each: `ready` (names of outputs), `ack` (a sequence), `trip` (their count), `trouble` (why it
ends, or what is wrong with an output), `well` (the outputs do again).
"""

import asyncio
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.guard.heartbeat import LENGTH, Heartbeat
from elbowroom.guard.output import Output, outputs_of
from elbowroom.guard.watch import Said, Watched

LINGER_S = 2.0
"""For so long outputs say stop after the monitor is gone, before this process is gone too."""
LOOKS_PER_DEADLINE = 4


class Watchdog(asyncio.Protocol):
    """Hears the monitor, looks at the clock, tells the outputs.

    Args:
        told: its configuration.
        report: takes what is reported to the monitor; it does not wait.
        clock_ns: the clock of the heartbeats [ns].
    """

    def __init__(
        self,
        told: Mapping[str, Any],
        report: Callable[[Mapping[str, Any]], None],
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._watched = Watched(len(told["motions"]))
        self._look_s = told["deadline_ns"] / 1e9 / LOOKS_PER_DEADLINE
        self._report, self._clock_ns = report, clock_ns
        self._outputs: list[Output] = outputs_of(told, self.said)
        self._received = bytearray()
        self._gone = asyncio.Event()

    def said(self) -> Said:
        """What outputs say now."""
        now_ns = self._clock_ns()
        trips = self._watched.trips
        self._watched = self._watched.looking(now_ns)
        if self._watched.trips > trips:
            self._report({"trip": self._watched.trips})
        return self._watched.said(now_ns)

    async def run(self) -> None:
        """Until the monitor is gone, and a while longer if it did not say so before.

        Raises:
            OSError, ElbowroomError: an output cannot be started.
        """
        for output in self._outputs:
            await output.begin()
        self._report({"ready": [output.name for output in self._outputs]})
        loop = asyncio.get_running_loop()
        await loop.connect_read_pipe(lambda: self, sys.stdin.buffer)
        until_s = None
        while until_s is None or loop.time() < until_s:
            self.tell()
            await asyncio.sleep(self._look_s)
            if self._gone.is_set() and until_s is None:
                until_s = loop.time() + (0.0 if self._is_over else LINGER_S)
        for output in self._outputs:
            await output.end()

    def tell(self) -> None:
        """Tells every output what is said now; if one fails, all are told stop."""
        failed = None
        for output in self._outputs:
            try:
                output.say(self.said())
            except Exception as error:  # whatever a function of the site's raises is a stop
                failed = f"{output.name}: {type(error).__name__}: {error}"
        if failed != self._watched.broken:
            self._watched = replace(self._watched, broken=failed)
            self._report({"well": True} if failed is None else {"trouble": failed})

    @property
    def _is_over(self) -> bool:
        """Whether the monitor said that it ends."""
        heartbeat = self._watched.heartbeat
        return heartbeat is not None and heartbeat.is_last

    def data_received(self, data: bytes) -> None:
        """Heartbeats, or parts of them; what is none ends them all."""
        self._received += data
        while len(self._received) >= LENGTH.size:
            (length,) = LENGTH.unpack_from(self._received)
            if len(self._received) < LENGTH.size + length:
                return
            packed = bytes(self._received[LENGTH.size : LENGTH.size + length])
            del self._received[: LENGTH.size + length]
            try:
                self._hear(Heartbeat.unpacked(packed))
            except ElbowroomError as error:
                self._end(f"the monitor sends what is no heartbeat: {error}")

    def connection_lost(self, error: Exception | None) -> None:
        """The monitor is gone."""
        self._end("the monitor is gone")

    def _hear(self, heartbeat: Heartbeat) -> None:
        self.said()  # silence that ends now was one
        self._watched = self._watched.hearing(heartbeat)
        self._report({"ack": heartbeat.sequence})
        self.tell()

    def _end(self, why: str) -> None:
        self._watched = replace(self._watched, ended=self._watched.ended or why)
        self._gone.set()


def _reporter() -> Callable[[Mapping[str, Any]], None]:
    """Writes lines to standard output and never waits: what the monitor does not read is lost."""
    descriptor = sys.stdout.fileno()
    os.set_blocking(descriptor, False)

    def report(told: Mapping[str, Any]) -> None:
        try:
            os.write(descriptor, json.dumps(told).encode() + b"\n")
        except OSError:
            return

    return report


async def _watch(told: Mapping[str, Any], report: Callable[[Mapping[str, Any]], None]) -> None:
    await Watchdog(told, report).run()


def main() -> int:
    """Runs the watchdog; 1: an output could not be started, and a report says why."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the monitor, which says when it ends
    report = _reporter()
    try:
        asyncio.run(_watch(json.loads(sys.argv[1]), report))
    except (OSError, ElbowroomError) as error:
        report({"trouble": str(error)})
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
