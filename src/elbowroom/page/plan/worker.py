"""Reckons in a thread of its own: a first answer of the newest layout at once, the exact one when the hand rests."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from elbowroom.errors import ElbowroomError
from elbowroom.page.plan.figures import Figures, Reckoner
from elbowroom.page.plan.layout import Layout
from elbowroom.page.plan.stale import Stale

LISTENS_S = 0.2


@dataclass(frozen=True, slots=True)
class Said:
    """What is known of a layout.

    Args:
        layout: which.
        figures: None: it has none, `trouble` says why.
        trouble: one line; None: there is none.
        seconds: from when the layout was given until its figures were there.
    """

    layout: Layout
    figures: Figures | None
    trouble: str | None
    seconds: float


@dataclass(slots=True, eq=False)
class Worker:
    """Newest wins: a layout that came meanwhile ends the work on the one before.

    Args:
        coarse, exact: the two that reckon.
        tell: told of each answer, in the worker's thread.
    """

    coarse: Reckoner
    exact: Reckoner
    tell: Callable[[Said], None]
    _waits: threading.Condition = field(default_factory=threading.Condition, init=False)
    _newest: tuple[Layout, float] | None = field(default=None, init=False)
    _is_over: bool = field(default=False, init=False)
    _thread: threading.Thread | None = field(default=None, init=False)

    def start(self) -> None:
        """Begins."""
        self._thread = threading.Thread(target=self._run, name="plan", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Ends."""
        with self._waits:
            self._is_over = True
            self._waits.notify()
        if self._thread is not None:
            self._thread.join(5.0)

    def give(self, layout: Layout) -> None:
        """Asks for the figures of a layout; never waits."""
        with self._waits:
            self._newest = layout, time.perf_counter()
            self._waits.notify()

    def _run(self) -> None:
        while not self._is_over:
            with self._waits:
                if self._newest is None:
                    self._waits.wait(LISTENS_S)
                given, self._newest = self._newest, None
            if given is not None:
                self._reckon(*given)

    def _reckon(self, layout: Layout, since_s: float) -> None:
        for reckoner in (self.coarse, self.exact):
            # a first answer is always given, or there would be none while somebody drags
            is_stale = self._is_stale if reckoner is self.exact else lambda: False
            try:
                figures, trouble = reckoner.figures(layout, is_stale), None
            except Stale:
                return
            except ElbowroomError as error:
                figures, trouble = None, str(error)
            self.tell(Said(layout, figures, trouble, time.perf_counter() - since_s))
            if trouble is not None or self._is_stale():
                return

    def _is_stale(self) -> bool:
        return self._newest is not None or self._is_over
