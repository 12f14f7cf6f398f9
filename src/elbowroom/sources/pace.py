"""Real time for what was recorded: a moment comes no earlier after the first one than it did; gaps are skipped."""

import time
from dataclasses import dataclass, field

from elbowroom.sensing import Snapshot

SLACK_S = 0.001
"""Nobody sleeps for less."""


@dataclass(slots=True, eq=False)
class Pace:
    """Waits until a snapshot's time has come, counted from the first one, or from the last gap.

    Args:
        gap_ns: what comes later than this after the one before comes at once [ns].
    """

    gap_ns: int = 5_000_000_000
    _first: tuple[int, float] | None = field(default=None, init=False)
    _last_ns: int = field(default=0, init=False)

    def wait(self, snapshot: Snapshot) -> None:
        """Sleeps while the snapshot is early."""
        early_s = self.early_s(snapshot)
        if early_s > SLACK_S:
            time.sleep(early_s)

    def early_s(self, snapshot: Snapshot) -> float:
        """For how long the snapshot's time has not come [s]: 0 where it has no time, is late, or comes after a gap."""
        if snapshot.now_ns is None:
            return 0.0
        now_s = time.perf_counter()
        if self._first is None or not 0 <= snapshot.now_ns - self._last_ns <= self.gap_ns:
            self._first = snapshot.now_ns, now_s
        self._last_ns = snapshot.now_ns
        first_ns, start_s = self._first
        return max(0.0, (snapshot.now_ns - first_ns) / 1e9 - (now_s - start_s))
