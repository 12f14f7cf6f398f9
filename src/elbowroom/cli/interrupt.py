"""Ctrl-C as an end like others, or as a wish to be done."""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def ended_by_interrupt() -> Iterator[None]:
    """Ctrl-C, and the system's request to end, leave the block as its end would."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    except KeyboardInterrupt:
        pass
    finally:
        signal.signal(signal.SIGTERM, before)


@contextmanager
def asked_to_end(what_is_kept: str) -> Iterator[Callable[[], bool]]:
    """Whether Ctrl-C asked to come to an end; a second one interrupts as ever.

    Args:
        what_is_kept: words for what is still done, such as "the best layout so far is verified and written".
    """
    asked = threading.Event()

    def ask(*_: object) -> None:
        if asked.is_set():
            raise KeyboardInterrupt
        asked.set()
        print(f"stopping: {what_is_kept}; Ctrl-C again ends at once", file=sys.stderr)

    before = signal.signal(signal.SIGINT, ask)
    try:
        yield asked.is_set
    finally:
        signal.signal(signal.SIGINT, before)
