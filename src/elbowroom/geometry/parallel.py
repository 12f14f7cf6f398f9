"""Spreads kernels that release the GIL over threads; the parts of work write to places of their own."""

import os
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
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
    """Does `work` for each item on up to `threads` threads (None: all cores) and returns the results in order.

    The calling thread works as well, and nobody is woken for single items. After an error no further item is begun.
    """
    threads = min(threads or default_threads(), len(items))
    if threads <= 1:
        return [work(item) for item in items]
    results: dict[int, Result] = {}
    waiting = deque(enumerate(items))

    def go_on() -> None:
        try:
            while True:
                try:
                    number, item = waiting.popleft()
                except IndexError:
                    return
                results[number] = work(item)
        except BaseException:
            waiting.clear()
            raise

    others = [_pool(threads - 1).submit(go_on) for _ in range(threads - 1)]
    try:
        go_on()
    finally:
        # those that have not begun have nothing left to do
        begun = [other for other in others if not other.cancel()]
        wait(begun)
    for other in begun:
        other.result()
    return [results[number] for number in range(len(items))]
