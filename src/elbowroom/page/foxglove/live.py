"""A run for Foxglove: what the monitor's board says, sent on."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from elbowroom.page.board.board import Board, read_images, read_planes
from elbowroom.page.foxglove.bridge import Bridge
from elbowroom.page.story.told import Told

LOOKS_S = 1 / 60
"""The board is looked at so often [s]."""
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
    _told: Told | None = field(default=None, init=False)
    _text: int = field(default=0, init=False)
    _planes: int = field(default=0, init=False)
    _images: int = field(default=0, init=False)
    _asked_s: float = field(default=0.0, init=False)

    def run(self) -> None:
        """Sends what comes, until it is over."""
        while not self.is_over():
            begun_s = time.monotonic()
            self._look(begun_s)
            time.sleep(max(0.0, LOOKS_S - (time.monotonic() - begun_s)))

    def _look(self, now_s: float) -> None:
        if self.board.text.number != self._text:
            found = self.board.text.get()
            if found is not None:
                self._text = found[0]
                told: dict[str, Any] = json.loads(found[1])
                self._told = None if told.get("ended") else told
                if self._told is not None:
                    self.bridge.tell(self._told)
        if self._told is None:
            return
        if self.board.planes.number != self._planes:
            planes = self.board.planes.get()
            if planes is not None and self.bridge.show_space(self._told, read_planes(planes[1])[1]):
                self._planes = planes[0]
        self._look_at_images(now_s)

    def _look_at_images(self, now_s: float) -> None:
        if self.bridge.wanted_depth and now_s - self._asked_s >= IMAGES_S:
            self._asked_s = now_s
            self.board.ask()
        if self.board.images.number != self._images:
            found = self.board.images.get()
            if found is not None:
                self._images = found[0]
                answered = read_images(found[1])
                self.bridge.show_images(answered.told, answered.snapshot)
