"""A run for Foxglove: what the monitor's board says, sent on."""

from collections.abc import Callable
from dataclasses import dataclass, field

from elbowroom.page.board.board import Board
from elbowroom.page.board.reader import Reader, look_until
from elbowroom.page.foxglove.bridge import Bridge
from elbowroom.page.story.told import Told

IMAGES_S = 0.5
"""Images are asked for so often, while somebody wants some [s]."""


@dataclass(slots=True, eq=False)
class LiveBridge:
    """Feeds a bridge from a board.

    Args:
        bridge: that viewers read.
        board: that the monitor writes.
        is_over: whether to end.
    """

    bridge: Bridge
    board: Board
    is_over: Callable[[], bool]
    _news: Reader = field(init=False)
    _told: Told | None = field(default=None, init=False)
    _asked_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        self._news = Reader(self.board)

    def run(self) -> None:
        """Sends what comes, until it is over."""
        look_until(self.is_over, self._look)

    def _look(self, now_s: float) -> None:
        told = self._news.told()
        if told is not None:
            self._told = None if told.get("ended") else told
            if self._told is not None:
                self.bridge.tell(self._told)
        now = self._told
        if now is None:
            return
        self._news.planes(lambda planes: self.bridge.show_space(now, planes))
        if self.bridge.wanted_depth and now_s - self._asked_s >= IMAGES_S:
            self._asked_s = now_s
            self.board.ask()
        answered = self._news.images()
        if answered is not None:
            self.bridge.show_images(answered.told, answered.snapshot)
