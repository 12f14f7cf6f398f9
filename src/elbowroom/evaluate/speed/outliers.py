"""Why the slowest pass of many was the slowest: what it waited for more than others do."""

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import numpy as np

OFTEN = 3
"""Put aside so many times more than the middling pass is a cause."""
PAGES = 2000
"""So many fresh pages more than the middling pass is one as well."""


@dataclass(frozen=True, slots=True)
class Spent:
    """What one pass took.

    Args:
        ms: of the clock [ms].
        put_aside: how often the system gave the processor to others.
        pages: of memory that the system had to fetch.
        collections: of garbage.
        stage_ms: by stage, where the pass says so [ms].
    """

    ms: float
    put_aside: int
    pages: int
    collections: int
    stage_ms: Mapping[str, float]


class Watch:
    """Notes what the work within it takes: `with Watch() as watch: ...`, then `watch.spent(stage_ms)`."""

    def __enter__(self) -> Self:
        self._before = _counts()
        self._begun = time.perf_counter()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._ms = (time.perf_counter() - self._begun) * 1e3
        self._after = _counts()

    def spent(self, stage_ms: Mapping[str, float]) -> Spent:
        """What it took, with the times of its stages [ms]."""
        put_aside, pages, collections = (b - a for a, b in zip(self._before, self._after, strict=True))
        return Spent(self._ms, put_aside, pages, collections, stage_ms)


def _counts() -> tuple[int, int, int]:
    collections = sum(generation["collections"] for generation in gc.get_stats())
    try:
        import resource
    except ImportError:  # Windows
        return 0, 0, collections
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_nivcsw, usage.ru_minflt + usage.ru_majflt, collections


def cause_of_worst(spent: Sequence[Spent]) -> str:
    """In words, what the slowest pass took longer for than the middling one.

    Args:
        spent: of all passes, at least one.
    """
    worst = max(spent, key=lambda one: one.ms)

    def over(value: Callable[[Spent], float]) -> float:
        return value(worst) - float(np.median([value(one) for one in spent]))

    causes = []
    if worst.stage_ms:
        stage = max(worst.stage_ms, key=lambda name: over(lambda one: one.stage_ms.get(name, 0.0)))
        causes.append(f"{stage} +{over(lambda one: one.stage_ms.get(stage, 0.0)):.0f} ms")
    if (often := over(lambda one: one.put_aside)) >= OFTEN:
        causes.append(f"put aside by the system {often:.0f} times more")
    if (pages := over(lambda one: one.pages)) >= PAGES:
        causes.append(f"{pages:.0f} fresh pages more")
    if over(lambda one: one.collections) > 0:
        causes.append("garbage was collected")
    return ", ".join(causes) or "nothing that is counted"
