"""Spreads kernels that release the GIL over threads; the parts of work write to places of their own."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def default_threads() -> int:
    """The number of cores that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=threads, thread_name_prefix="elbowroom")


def spread(work: Callable[[Item], Result], items: Sequence[Item], threads: int | None = None) -> list[Result]:
    """Does `work` for each item on up to `threads` threads (None: all cores) and returns the results in order."""
    threads = threads or default_threads()
    if threads == 1 or len(items) <= 1:
        return [work(item) for item in items]
    return list(_pool(threads).map(work, items))
