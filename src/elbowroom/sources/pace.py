"""Real time for what was recorded: a moment comes no earlier after the first one than it did."""

import time
from dataclasses import dataclass, field

from elbowroom.sensing import Snapshot

SLACK_S = 0.001
"""Nobody sleeps for less."""


@dataclass(slots=True, eq=False)
class Pace:
    """Waits until a snapshot's time has come, counted from the first one."""

    _first: tuple[int, float] | None = field(default=None, init=False)

    def wait(self, snapshot: Snapshot) -> None:
        """Sleeps while the snapshot is early; not at all where it has no time, or is late."""
        if snapshot.now_ns is None:
            return
        if self._first is None:
            self._first = snapshot.now_ns, time.perf_counter()
        first_ns, start_s = self._first
        early_s = (snapshot.now_ns - first_ns) / 1e9 - (time.perf_counter() - start_s)
        if early_s > SLACK_S:
            time.sleep(early_s)
