"""Throws every kind of fault at a running monitor at random moments, and looks whether and when the machine stops."""

import os
import queue
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from json import dumps, loads
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.errors import ElbowroomError, InputError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.faults.kinds import KINDS, Kind
from elbowroom.evaluate.faults.receiver import Receiver
from elbowroom.evaluate.faults.scene import PLACES, written_site
from elbowroom.guard.control import ask

DUE = (
    Due("silent", "≤", 0, words="faults that pass silently"),
    Due("misnamed", "≤", 0, words="causes named wrongly"),
    Due("worst_ms", "≤", 150, words="each stop after the fault shows, worst of 1,000"),
)
START_S, GUARDING_S = 180.0, 20.0
SETTLES_S = 0.8
"""By then it is known how often each camera gives an image [s]."""
BURNERS = 24
MOVING = ("guarding", "starting")
STARVED_S, LATCHED_S = 4.0, 4.0
NOTICERS = {
    "camera": "streams",
    "joints": "streams",
    "silence": "watchdog",
    "input": "looks",
    "watch": "watch",
}


class Cell:
    """A folder, a monitor's process, and the receiver.

    Args:
        folder: of all files.
        deadline_ms: of the gate.
    """

    def __init__(self, folder: Path, deadline_ms: float) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        self.deadline_ns = round(deadline_ms * 1e6)
        self.site = written_site(folder, port, deadline_ms)
        self.gate = folder / "gate"
        self.black_box: Sequence[str] = ()
        self.receiver = Receiver(port, 2)
        self.process: subprocess.Popen[str] | None = None
        self.watchdog: int | None = None
        self.said: queue.Queue[dict[str, Any]] = queue.Queue()
        self.troubles: list[str] = []
        """What the monitor last said that it could not keep."""

    def start(self) -> None:
        """Starts the monitor, or another one.

        Raises:
            ElbowroomError: it does not start.
        """
        self.stop()
        words = [sys.executable, "-m", "elbowroom.evaluate.faults.monitored", str(self.site), str(self.gate)]
        words += self.black_box
        self.process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.said = queue.Queue()
        threading.Thread(target=self._listen, args=(self.process, self.said), daemon=True).start()
        ready = self.next_said("ready", START_S)
        if ready is None:
            self.stop()
            raise ElbowroomError("evaluate faults: the monitor does not start")
        self.watchdog = ready["watchdog"]
        time.sleep(SETTLES_S)

    def tell(self, **what: Any) -> None:
        """Sends a line to the monitor; one that has ended hears nothing."""
        assert self.process is not None and self.process.stdin is not None
        with suppress(OSError):
            self.process.stdin.write(dumps(what) + "\n")
            self.process.stdin.flush()

    def next_said(self, key: str, most_s: float) -> dict[str, Any] | None:
        """The next line of the monitor with a key; None: none came in time.

        Args:
            key: of the line.
            most_s: to wait [s].
        """
        until_s = time.monotonic() + most_s
        while (left_s := until_s - time.monotonic()) > 0:
            with suppress(queue.Empty):
                line = self.said.get(timeout=left_s)
                self.troubles = line.get("troubles", self.troubles)
                if key in line:
                    return line
        return None

    def status(self) -> dict[str, Any]:
        """What the gate says; nothing where it does not answer."""
        with suppress(InputError, OSError, ValueError):
            return ask(self.gate, "status")
        return {}

    def guards(self) -> bool:
        """Waits until the machine may move, resetting what is over; whether it came to that."""
        until_s = time.monotonic() + GUARDING_S
        while time.monotonic() < until_s:
            if self.receiver.last.goes:
                return True
            if self.receiver.last.phase == "cleared":
                with suppress(InputError):
                    ask(self.gate, "reset")
            time.sleep(0.02)
        return False

    def signal(self, number: signal.Signals) -> None:
        """Sends a signal to the monitor."""
        assert self.process is not None
        self.process.send_signal(number)

    def stop(self) -> None:
        """Ends the monitor, if one runs."""
        if self.process is not None:
            self.process.kill()
            self.process.communicate()
            self.process = None

    def end(self) -> None:
        """Ends all."""
        self.stop()
        self.receiver.close()

    @staticmethod
    def _listen(process: subprocess.Popen[str], said: "queue.Queue[dict[str, Any]]") -> None:
        assert process.stdout is not None
        with suppress(ValueError):
            for line in process.stdout:
                said.put(loads(line))


def fault_rows(
    times: int = 25, seed: int = 1, deadline_ms: float = 60.0, kinds: Sequence[Kind] = KINDS
) -> Iterator[dict[str, Any]]:
    """One row for each fault that was thrown.

    Args:
        times: how often each kind is.
        seed: of the moments and the cameras.
        deadline_ms: of the gate; two of them without a pass are silence. A loaded computer needs a longer one.
        kinds: of faults.

    Raises:
        ElbowroomError: the monitor does not start, or does not let the machine move though nothing is wrong.
    """
    chance = random.Random(seed)
    # those after which the monitor is started again come last, so that few starts are needed
    turns = [kind for _ in range(times) for kind in kinds if not kind.restarts]
    turns += [kind for kind in kinds if kind.restarts for _ in range(times)]
    with TemporaryDirectory() as folder:
        cell = Cell(Path(folder), deadline_ms)
        try:
            cell.start()
            for kind in turns:
                yield thrown(cell, kind, chance)
        finally:
            cell.end()


def thrown(cell: Cell, kind: Kind, chance: random.Random) -> dict[str, Any]:
    """What one fault comes to.

    Args:
        cell: that runs.
        kind: of the fault.
        chance: when, and at which camera.

    Raises:
        ElbowroomError: the machine does not move though nothing is wrong.
    """
    if not cell.guards():
        cell.start()  # what the watch found stays until then
    if not cell.guards():
        raise ElbowroomError(
            f"evaluate faults: the machine does not move before {kind.name}: {cell.status()}"
        )
    time.sleep(chance.uniform(0.05, 0.5))
    camera = chance.choice(sorted(PLACES))
    while not cell.said.empty():
        cell.said.get()
    shows_ns = _begin(cell, kind, camera, chance)
    until_s = time.monotonic() + kind.most_s
    while shows_ns is not None and cell.receiver.last.phase in MOVING and time.monotonic() < until_s:
        time.sleep(0.002)
    # what only lies in the way for a moment is no stop
    stopped_ns = None if cell.receiver.last.phase in MOVING else cell.receiver.stopped_ns
    latched = _latched(cell, kind)
    cell.tell(end=True)
    if kind.restarts:
        cell.start()
    named = [each for each in latched if _names(each, kind, camera)]
    first = latched[0]["reason"] if latched else "nothing"
    return {
        "case": kind.name,
        "input": kind.input,
        "shown": shows_ns is not None,
        "stopped": stopped_ns is not None,
        "after_ms": None if stopped_ns is None or shows_ns is None else max(stopped_ns - shows_ns, 0) / 1e6,
        "latched": [f"{each['reason']} {each['subject']}".strip() for each in latched],
        "noticed_by": NOTICERS.get(first.split("_")[0], "pass" if first in ("fault", "stale") else "gate"),
        "named": bool(named),
    }


def _names(latched: dict[str, str], kind: Kind, camera: str) -> bool:
    """Whether a fault that latched names this one, and its camera."""
    reason, subject = latched["reason"], latched["subject"]
    if reason.startswith("camera_") and kind.input == "camera":
        return reason in kind.causes and subject == camera
    return reason in kind.causes or f"{reason} {subject.split(' ')[0]}".strip() in kind.causes


def _latched(cell: Cell, kind: Kind) -> list[dict[str, str]]:
    """What the gate has latched by now; of one that was killed, what the next one finds."""
    until_s = time.monotonic() + LATCHED_S
    found: list[dict[str, str]] = []
    while time.monotonic() < until_s and not found:
        if kind.restarts and cell.process is not None and cell.process.poll() is not None:
            cell.start()
            until_s = time.monotonic() + LATCHED_S
        found = cell.status().get("latched", [])
        time.sleep(0.01)
    return found


def _begin(cell: Cell, kind: Kind, camera: str, chance: random.Random) -> int | None:
    """Begins a fault; when it shows [ns of `time.monotonic_ns`]; None: it does not."""
    if kind.make is not None:
        cell.tell(begin=kind.name, of=kind.input, camera=camera, seed=chance.randrange(2**31))
        shown = cell.next_said("shows_ns", kind.most_s)
        return None if shown is None else int(shown["shows_ns"])
    return FROM_OUTSIDE[kind.name](cell)


def _hung(cell: Cell) -> int | None:
    cell.tell(hang=1.0)
    shown = cell.next_said("shows_ns", 3.0)
    return None if shown is None else int(shown["shows_ns"])


def _short(cell: Cell) -> int | None:
    cell.tell(memory=True)
    shown = cell.next_said("shows_ns", 3.0)
    return None if shown is None else int(shown["shows_ns"])


def _suspended(cell: Cell) -> int | None:
    at_ns = time.monotonic_ns()
    cell.signal(signal.SIGSTOP)
    time.sleep(1.0)
    cell.signal(signal.SIGCONT)
    return at_ns


def _killed(cell: Cell) -> int | None:
    at_ns = time.monotonic_ns()
    cell.signal(signal.SIGKILL)
    time.sleep(1.0)
    return at_ns


def _without_watchdog(cell: Cell) -> int | None:
    assert cell.watchdog is not None and cell.process is not None
    at_ns = time.monotonic_ns()
    status = cell.process.pid
    os.kill(_child_of(status) or cell.watchdog, signal.SIGKILL)
    return at_ns


def _child_of(process: int) -> int | None:
    """The watchdog that a monitor has now: one that was killed has a successor."""
    with suppress(OSError, ValueError, IndexError):
        text = Path(f"/proc/{process}/task/{process}/children").read_text()
        return int(text.split()[-1])
    return None


def _starved(cell: Cell) -> int | None:
    """Many busy processes share one core with the monitor, for a while. It shows when the first deadline is missed."""
    assert cell.process is not None
    before = {int(task.name): os.sched_getaffinity(int(task.name)) for task in _tasks(cell.process.pid)}
    core = min(os.sched_getaffinity(0))
    for task in before:
        os.sched_setaffinity(task, {core})
    words = [sys.executable, "-c", f"import os; os.sched_setaffinity(0, {{{core}}})\nwhile True: pass"]
    burners = [subprocess.Popen(words) for _ in range(BURNERS)]
    until_s = time.monotonic() + STARVED_S
    while time.monotonic() < until_s and cell.receiver.last.phase in MOVING:
        time.sleep(0.002)
    for burner in burners:
        burner.kill()
        burner.wait()
    time.sleep(0.3)
    for task, cores in before.items():
        with suppress(OSError):
            os.sched_setaffinity(task, cores)
    is_slow_enough = cell.receiver.last.phase not in MOVING
    return cell.receiver.went.finished_ns + cell.deadline_ns if is_slow_enough else None


def _tasks(process: int) -> list[Path]:
    return list(Path(f"/proc/{process}/task").iterdir())


FROM_OUTSIDE: dict[str, Callable[[Cell], int | None]] = {
    "hangs: a source that waits 1 s": _hung,
    "suspended for 1 s": _suspended,
    "starved of processor time": _starved,
    "short of memory": _short,
    "killed": _killed,
    "watchdog killed": _without_watchdog,
}


def fault_summary(rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row for each kind, then one for all: how often it showed, passed silently, was misnamed; how long stops took.

    Args:
        rows: of `fault_rows`.
    """
    found = []
    for of in dict.fromkeys((row["case"], row["input"]) for row in rows):
        found.append(_summed(of[0], of[1], [row for row in rows if (row["case"], row["input"]) == of]))
    return [*found, _summed("all", "", rows)]


def _summed(case: str, of: str, rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    shown = [row for row in rows if row["shown"]]
    after_ms = [row["after_ms"] for row in shown if row["after_ms"] is not None]
    return {
        "case": case,
        "input": of,
        "times": len(rows),
        "shown": len(shown),
        "silent": sum(not row["stopped"] for row in shown),
        "misnamed": sum(row["stopped"] and not row["named"] for row in shown),
        "median_ms": float(np.median(after_ms)) if after_ms else None,
        "worst_ms": max(after_ms, default=None),
        "noticed_by": ", ".join(dict.fromkeys(row["noticed_by"] for row in shown)) if case != "all" else "",
        "causes": ", ".join(dict.fromkeys(row["latched"][0].split()[0] for row in shown if row["latched"]))
        if case != "all"
        else "",
    }
