"""The monitor that faults are thrown at, in a process of its own.

    python -m elbowroom.evaluate.faults.monitored SITE GATE [BLACK_BOX [BYTES]]

It takes a line of JSON on its standard input for each thing to do: {"begin": NAME, "of": INPUT, "camera": NAME, "seed":
N}, {"end": true}, {"hang": S}, {"memory": true}. It says a line of JSON when it is ready, when a fault shows (in ns of
`time.monotonic_ns`), for each cause when it comes, and when the black box cannot keep a stop. No file of this process
grows beyond BYTES.
"""

import json
import os
import random
import resource
import signal
import sys
import threading
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from elbowroom.evaluate.faults.kinds import kind_named
from elbowroom.evaluate.faults.live import Live
from elbowroom.monitor.blackbox.made import recorder_of
from elbowroom.monitor.blackbox.recorder import Recorder
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.made import gate_of
from elbowroom.monitor.start.start import started
from elbowroom.site import Site
from elbowroom.sources import Room, open_room

SPARE_BYTES = 2_000_000
"""So little memory is left to a process that is to be short of it."""


class Reporter:
    """The face that says which causes are there, where they change."""

    def __init__(self, gate: Gate, recorder: Recorder | None = None) -> None:
        self._gate, self._said, self._is_ready = gate, [[""]], False
        self._recorder, self._troubles = recorder, list[str]()

    def begin(self, room: Room) -> None:
        """Nothing has been judged."""

    def show(self, done: Pass) -> None:
        """Says what is new."""
        if not self._is_ready:
            self._is_ready = True
            link = self._gate.watchdog
            say({"ready": True, "watchdog": None if link is None else link.process_id})
        sick = [[each.cause.value.name.lower(), each.source] for each in done.result.sick]
        if sick != self._said:
            self._said = sick
            say({"sick": sick, "at_ns": time.monotonic_ns(), "sequence": done.result.sequence})

        troubles = [] if self._recorder is None else self._recorder.troubles
        if troubles != self._troubles:
            self._troubles = troubles
            say({"troubles": troubles})

    def end(self) -> None:
        """The run has ended."""


def say(told: Mapping[str, Any]) -> None:
    """A line on standard output."""
    print(json.dumps(dict(told)), flush=True)


def do(asked: Mapping[str, Any], live: Live) -> None:
    """Does what a line asks.

    Args:
        asked: of the line.
        live: the source.
    """
    if "begin" in asked:
        make = kind_named(asked["begin"], asked["of"]).make
        if make is not None:
            live.begin(make(asked["camera"], random.Random(asked["seed"])))
    elif "hang" in asked:
        live.hang(asked["hang"])
    elif "memory" in asked:
        say({"shows_ns": time.monotonic_ns()})
        take_memory()
    else:
        live.end()


def take_memory() -> None:
    """Leaves this process next to nothing to allocate."""
    with Path("/proc/self/statm").open() as file:
        size = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (size + SPARE_BYTES, resource.RLIM_INFINITY))
    kept = []
    for many in (1 << 20, 1 << 16, 1 << 12):
        while True:
            try:
                kept.append(bytearray(many))
            except MemoryError:
                break
    HELD.append(kept)


HELD: list[Any] = []
"""What `take_memory` took."""


def listen(live: Live) -> None:
    """Does what is asked, line by line, in a thread of its own; ends with whoever asks."""
    for line in sys.stdin:
        do(json.loads(line), live)
    os.kill(os.getpid(), signal.SIGKILL)


def main() -> None:
    """Runs the monitor until it is killed."""
    path, folder, *box = map(Path, sys.argv[1:4])
    if sys.argv[4:]:
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[4]), resource.RLIM_INFINITY))
    room = open_room(Site.load(path))
    live = Live(room.cameras)
    live.on_shown = lambda at_ns: say({"shows_ns": at_ns})
    room = replace(room, source=live)
    gate = gate_of(room, folder)
    assert gate is not None
    loop = replace(started(room, lambda told: None), gate=gate)
    threading.Thread(target=listen, args=(live,), daemon=True).start()
    recorder = recorder_of(room, folder=box[0]) if box else None
    if recorder is not None:
        recorder.cycle = loop.cycle
    loop.run([Reporter(gate, recorder), *([] if recorder is None else [recorder])])


if __name__ == "__main__":
    main()
