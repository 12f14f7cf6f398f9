"""The face that tells the page; it hands each pass to a thread of its own, and never waits."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from elbowroom.monitor.face import Pass
from elbowroom.page.board.board import Board
from elbowroom.page.scene.near import Planes
from elbowroom.page.story.told import told_of
from elbowroom.reconstruct import FreeSpace
from elbowroom.sources import Room

TEXT_EVERY_S, PLANES_EVERY_S = 1 / 30, 0.1
"""The page is told no more often than so [s]."""
LISTENS_S, ASKED_S = 0.02, 0.01
"""So often it is looked whether images are asked for: while nothing comes, and between two passes [s]."""


@dataclass(slots=True, eq=False)
class PageFace:
    """Tells a board of passes; the newest counts, and one that comes too soon after another is not told.

    Args:
        board: that the page reads.
    """

    board: Board
    fault: str | None = field(default=None, init=False)
    """Why the page is not told any more; None: it is."""
    _newest: tuple[Pass, int] | None = field(default=None, init=False)
    _waits: threading.Condition = field(default_factory=threading.Condition, init=False)
    _is_over: bool = field(default=False, init=False)
    _shown_s: float = field(default=float("-inf"), init=False)
    _last: tuple[Pass, int] | None = field(default=None, init=False)
    _answered: int = field(default=0, init=False)
    _thread: threading.Thread | None = field(default=None, init=False)

    def begin(self, room: Room) -> None:
        """Begins the thread."""
        self._thread = threading.Thread(target=self._tell, name="page", daemon=True)
        self._thread.start()

    def show(self, done: Pass) -> None:
        """Hands on a pass; one that was handed on before and not told yet is forgotten."""
        with self._waits:
            self._newest = done, time.time_ns()
            self._waits.notify()

    def end(self) -> None:
        """Says that nobody watches any more."""
        with self._waits:
            self._is_over = True
            self._waits.notify()
        if self._thread is not None:
            self._thread.join(2.0)
        self.board.tell({"ended": True})

    def _tell(self) -> None:
        while not self._is_over:
            with self._waits:
                if self._newest is None:
                    self._waits.wait(LISTENS_S)
                given, self._newest = self._newest, None
            begun_s = time.monotonic()
            if given is not None:
                self._guarded(partial(self._write, *given))
            self._guarded(self._answer)
            if given is None:
                continue
            self._rest(begun_s + TEXT_EVERY_S)

    def _rest(self, until_s: float) -> None:
        """Waits until the next pass may be told; who asks for images meanwhile gets them."""
        while (left_s := until_s - time.monotonic()) > 0:
            time.sleep(min(left_s, ASKED_S))
            if self.board.asked != self._answered:
                self._guarded(self._answer)

    def _guarded(self, what: Callable[[], None]) -> None:
        try:
            what()
        except Exception as error:  # the monitor goes on, whatever the page is told
            self.fault = f"{type(error).__name__}: {error}"

    def _write(self, done: Pass, wall_ns: int) -> None:
        self._last = done, wall_ns
        told, space = told_of(done, wall_ns), done.result.space
        self.board.tell(told)
        now_s = time.monotonic()
        if space is not None and now_s - self._shown_s >= PLANES_EVERY_S - TEXT_EVERY_S / 2:
            self._shown_s = now_s
            self.board.show(done.result.sequence, planes_of(space))

    def _answer(self) -> None:
        """Hands out the images of the newest pass, if they are asked for."""
        asked = self.board.asked
        if asked != self._answered and self._last is not None:
            self._answered = asked
            done, wall_ns = self._last
            self.board.answer(asked, told_of(done, wall_ns), done.snapshot)


def planes_of(space: FreeSpace) -> Planes:
    """Of a free space, what is drawn."""
    looked = np.zeros(0, dtype=np.bool_) if space.looked_at is None else space.looked_at
    return Planes(space.free_words, space.surface_words, space.blind_words, looked)
