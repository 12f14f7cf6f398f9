"""How long each stage of a pass takes."""

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
