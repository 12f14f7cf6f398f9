"""Ctrl-C as a wish to be done: what runs comes to its end, and nothing is cut in two.

An interrupt that is raised while compiled code runs can leave memory behind that is counted wrongly, and crash the
process later. So the first one only asks.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Ctrl-C, and the system's request to end."""


@contextmanager
def asked_to_end(what_is_kept: str | None = None) -> Iterator[Callable[[], bool]]:
    """Whether Ctrl-C or the system asked to come to an end; a second time interrupts as ever.

    Args:
        what_is_kept: words for what is still done, such as "the best layout so far is verified and written"; None: the
            end is near, and nothing is said.
    """
    asked = threading.Event()

    def ask(*_: object) -> None:
        if asked.is_set():
            raise KeyboardInterrupt
        asked.set()
        if what_is_kept is not None:
            print(f"stopping: {what_is_kept}; Ctrl-C again ends at once", file=sys.stderr)

    before = [(each, signal.signal(each, ask)) for each in SIGNALS]
    try:
        yield asked.is_set
    finally:
        for each, handler in before:
            signal.signal(each, handler)
