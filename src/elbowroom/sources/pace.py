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

    def wait(self, snapshot: Snapshot, until_s: float = float("inf")) -> bool:
        """Sleeps while the snapshot is early; not at all where it has no time, is late, or comes after a gap.

        Args:
            snapshot: that has come.
            until_s: at that time sleeping ends [s of `time.perf_counter`].

        Returns:
            Whether its time has come; otherwise `until_s` came before.
        """
        if snapshot.now_ns is None:
            return True
        now_s = time.perf_counter()
        if self._first is None or not 0 <= snapshot.now_ns - self._last_ns <= self.gap_ns:
            self._first = snapshot.now_ns, now_s
        self._last_ns = snapshot.now_ns
        first_ns, start_s = self._first
        comes_s = start_s + (snapshot.now_ns - first_ns) / 1e9
        early_s = min(comes_s, until_s) - now_s
        if early_s > SLACK_S:
            time.sleep(early_s)
        return comes_s <= until_s
