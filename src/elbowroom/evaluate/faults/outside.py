"""Faults that are done from outside, to the process of the monitor."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from elbowroom.evaluate.faults.cell import MOVING, Cell

BURNERS, STARVED_S = 24, 4.0


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
    words = [
        sys.executable,
        "-c",
        f"import os; os.sched_setaffinity(0, {{{core}}})\nwhose = os.getppid()\nwhile os.getppid() == whose: pass",
    ]
    # each in a session of its own, as the monitor is: where sessions share the processor, one would have half of it
    burners = [subprocess.Popen(words, start_new_session=True) for _ in range(BURNERS)]
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
"""By the name of the kind: does it, and says when it shows [ns of `time.monotonic_ns`]; None: it does not."""
