"""Who shows or keeps what a run comes to, or acts on it: the screen, the rows of a file, pictures."""

from dataclasses import dataclass
from typing import Protocol

from elbowroom.monitor.gate.state import Decision
from elbowroom.monitor.result import CycleResult
from elbowroom.monitor.separation.margins import Margins
from elbowroom.sensing import Snapshot
from elbowroom.sources import Room


@dataclass(frozen=True, slots=True, eq=False)
class Pass:
    """One turn of the loop.

    Args:
        snapshot: what came.
        result: what it was judged to be.
        source_ms: what it took to bring the snapshot [ms], simulating or reading.
        decision: what the gate made of it; None: the run has no gate.
        margins: how far the machine was from what it may hit; None: nobody asks, or the pass failed.
    """

    snapshot: Snapshot
    result: CycleResult
    source_ms: float
    decision: Decision | None = None
    margins: Margins | None = None


class Face(Protocol):
    """Is told by the loop of the room, of every pass, in order, and of the end."""

    def begin(self, room: Room) -> None:
        """A run begins; nothing has been judged: who commands a machine says stop."""

    def show(self, done: Pass) -> None:
        """A pass has just ended."""

    def end(self) -> None:
        """There will be no more passes, for whatever reason: who commands a machine stops it."""
