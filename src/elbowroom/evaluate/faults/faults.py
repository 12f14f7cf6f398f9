"""Throws every kind of fault at a running monitor at random moments, and looks whether and when the machine stops."""

import random
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from elbowroom.errors import ElbowroomError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.faults.cell import MOVING, Cell
from elbowroom.evaluate.faults.kinds import KINDS, Kind
from elbowroom.evaluate.faults.outside import FROM_OUTSIDE
from elbowroom.evaluate.faults.scene import PLACES

DUE = (
    Due("silent", "≤", 0, words="faults that pass silently"),
    Due("misnamed", "≤", 0, words="causes named wrongly"),
    Due("worst_ms", "≤", 150, words="each stop after the fault shows, worst of 1,000"),
)
LATCHED_S = 4.0
AGAIN = 3
"""So often at most a fault is thrown at a machine that turns out to have stood already."""
NOTICERS = {
    "camera": "streams",
    "joints": "streams",
    "silence": "watchdog",
    "input": "looks",
    "watch": "watch",
}


def fault_rows(
    times: int = 25, seed: int = 1, deadline_ms: float = 60.0, kinds: Sequence[Kind] = KINDS
) -> Iterator[dict[str, Any]]:
    """One row for each fault that was thrown.

    Args:
        times: how often each kind is; half as often those after which the monitor has to be started again.
        seed: of the moments and the cameras.
        deadline_ms: of the gate; two of them without a pass are silence. A loaded computer needs a longer one.
        kinds: of faults.

    Raises:
        ElbowroomError: the monitor does not start, or does not let the machine move though nothing is wrong.
    """
    chance = random.Random(seed)
    turns = turns_of(times, kinds)
    with TemporaryDirectory() as folder:
        cell = Cell(Path(folder), deadline_ms)
        try:
            cell.start()
            for kind in turns:
                yield thrown(cell, kind, chance)
        finally:
            cell.end()


def turns_of(times: int, kinds: Sequence[Kind] = KINDS) -> list[Kind]:
    """Which faults are thrown, in order: those last after which the monitor has to be started again, and half as often.

    Args:
        times: how often each of the others is.
        kinds: of faults.
    """
    turns = [kind for _ in range(times) for kind in kinds if not kind.restarts]
    return turns + [kind for kind in kinds if kind.restarts for _ in range((times + 1) // 2)]


def thrown(cell: Cell, kind: Kind, chance: random.Random) -> dict[str, Any]:
    """What one fault comes to that is thrown while the machine may move.

    A computer that is busy stops the machine for a reason of its own, and then nothing can be told of the fault: it is
    thrown again, and `again` says how often.

    Args:
        cell: that runs.
        kind: of the fault.
        chance: when, and at which camera.

    Raises:
        ElbowroomError: the machine does not move though nothing is wrong.
    """
    again, row = 0, _thrown(cell, kind, chance)
    while row["stood"] and not kind.restarts and again < AGAIN:
        again, row = again + 1, _thrown(cell, kind, chance)
    return {**row, "again": again}


def _thrown(cell: Cell, kind: Kind, chance: random.Random) -> dict[str, Any]:
    """What one fault comes to."""
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
    starts = cell.starts
    stood = (
        kind.make is not None and stopped_ns is not None and shows_ns is not None and stopped_ns < shows_ns
    )
    latched = _latched(cell, kind) if shows_ns is not None else []
    cell.tell(end=True)
    if kind.restarts and cell.starts == starts:
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
        "stood": stood,
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
        "again": sum(row.get("again", 0) for row in rows),
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
