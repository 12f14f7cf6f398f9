"""Where the page is, said as soon as it is known."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from elbowroom.page.opened import OpenedPage


WAITS_S = 5.0
"""A run waits for so long until it is known where its page is [s]."""


@dataclass(slots=True)
class PageNote:
    """Says once where the page is, or why there is none, while the run is still being started.

    Args:
        note: is told the line.
        page: that was opened; a line: why there is none; None: nobody wanted one.
    """

    note: Callable[[str], None]
    page: "OpenedPage | str | None"
    _thread: threading.Thread | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if isinstance(self.page, str):
            self.note(self.page)
        elif self.page is not None:
            self._thread = threading.Thread(target=self._say, daemon=True)
            self._thread.start()

    def wait(self, most_s: float = WAITS_S) -> None:
        """Waits until it is said, since from here on the screen is another's; no longer than the run can wait.

        Args:
            most_s: so long at most [s]; it is said above the screen then, as soon as it is known.
        """
        if self._thread is not None:
            self._thread.join(most_s)

    def _say(self) -> None:
        assert self.page is not None and not isinstance(self.page, str)
        self.note(self.page.said())
