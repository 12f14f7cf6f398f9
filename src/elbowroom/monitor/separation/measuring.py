"""A short run of the monitor that measures reaction times, for the budget of a site."""

import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path

from elbowroom.errors import InputError
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.monitor.loop import Loop
from elbowroom.monitor.separation.budget import Budget, least_margins
from elbowroom.monitor.separation.margins import Margins
from elbowroom.site.gate_entry import GateEntry
from elbowroom.sources import Room

NS_A_MS = 1_000_000


@dataclass(slots=True, eq=False)
class _Heard:
    """The face that keeps the margins of each pass."""

    margins: list[Margins] = field(default_factory=list)
    passes: int = 0
    fault: str | None = None

    def begin(self, room: Room) -> None:
        """Nothing is to be done."""

    def show(self, done: Pass) -> None:
        """Keeps a pass."""
        self.passes += 1
        self.fault = self.fault or done.result.fault
        if done.margins is not None:
            self.margins.append(done.margins)

    def end(self) -> None:
        """Nothing is to be done."""


def gate_beside(loop: Loop, folder: Path) -> Gate:
    """A gate that decides and keeps its latch, but has no watchdog: nobody listens to it.

    Args:
        loop: whose motions it decides of.
        folder: a temporary one.
    """
    _, motions = loop.room.machine_and_motions()
    entry = GateEntry()
    rules = Rules(
        tuple(motion.name for motion in motions),
        round(entry.deadline_ms * NS_A_MS),
        entry.rise_per_s,
        entry.low_speed,
        round(entry.hold_ms * NS_A_MS),
    )
    return Gate(folder / "gate", loop.room.site.name, rules)


def measured_budget(loop: Loop, seconds: float) -> Budget:
    """Runs a loop for a while, with a gate of its own that nobody listens to, and says what it took.

    Args:
        loop: ready to run.
        seconds: how long; a recording may end before.

    Raises:
        InputError: no motion is judged, or a pass failed: what it took says nothing.
    """
    separating = loop.separating
    if separating is None:
        raise InputError("budget: no motion is judged here, so no machine has to stop")
    heard = _Heard()
    with tempfile.TemporaryDirectory() as folder:
        replace(loop, gate=gate_beside(loop, Path(folder))).run([heard], seconds)
    if heard.fault is not None:
        raise InputError(f"budget: a pass failed: {heard.fault}")
    margins = least_margins(heard.margins)
    return Budget(separating.figures, separating.watch.worst, heard.passes, margins)
