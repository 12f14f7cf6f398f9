"""How long each stage of a pass takes, and what is no fault of it."""

import time
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def timed(stage: str, stage_ms: dict[str, float]) -> Iterator[None]:
    """Notes how long a stage took [ms], also when it fails."""
    start = time.perf_counter()
    try:
        yield
    finally:
        stage_ms[stage] = (time.perf_counter() - start) * 1e3


def raise_interrupt(error: BaseException) -> None:
    """Raises the interrupt that an error stands for, if it does: one that comes while compiled code runs is wrapped in
    a `SystemError`, and a wish to end is no fault of a pass.

    Raises:
        KeyboardInterrupt: the error was caused by it.
    """
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, KeyboardInterrupt):
            raise cause
        cause = cause.__cause__
