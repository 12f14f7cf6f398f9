"""What is news on a board, for whoever shows it."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from elbowroom.page.board.board import Answered, Board, read_images, read_planes
from elbowroom.page.scene.near import Planes

LOOKS_S = 1 / 60
"""A board is looked at so often [s]."""


@dataclass(slots=True, eq=False)
class Reader:
    """Reads each thing once, the newest.

    Args:
        board: that the monitor writes.
    """

    board: Board
    _text: int = field(default=0, init=False)
    _planes: int = field(default=0, init=False)
    _images: int = field(default=0, init=False)

    def told(self) -> dict[str, Any] | None:
        """A pass that was not told before; None: there is none."""
        if self.board.text.number == self._text:
            return None
        found = self.board.text.get()
        if found is None:
            return None
        self._text = found[0]
        told: dict[str, Any] = json.loads(found[1])
        return told

    def planes(self, show: Callable[[Planes], bool]) -> None:
        """Planes that were not shown before are shown.

        Args:
            show: says whether it did; if not, they are still news.
        """
        if self.board.planes.number == self._planes:
            return
        found = self.board.planes.get()
        if found is not None and show(read_planes(found[1])[1]):
            self._planes = found[0]

    def images(self) -> Answered | None:
        """Images that were not read before; None: there are none."""
        if self.board.images.number == self._images:
            return None
        found = self.board.images.get()
        if found is None:
            return None
        self._images = found[0]
        return read_images(found[1])


def look_until(is_over: Callable[[], bool], look: Callable[[float], None]) -> None:
    """Looks again and again, as often as `LOOKS_S` says.

    Args:
        is_over: whether to end.
        look: given the time [s of `time.monotonic`].
    """
    while not is_over():
        begun_s = time.monotonic()
        look(begun_s)
        time.sleep(max(0.0, LOOKS_S - (time.monotonic() - begun_s)))
