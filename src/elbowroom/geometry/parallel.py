"""Spreads kernels that release the GIL over threads; the parts of work write to places of their own.

How many threads there are is a property of the pool, not of those who use it: one a core, or as many as `threads` says.
"""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from functools import cache
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")

_said: ContextVar[int | None] = ContextVar("elbowroom_threads", default=None)


def default_threads() -> int:
    """The number of cores that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def threads(count: int | None) -> Iterator[None]:
    """Within it, work is spread over so many threads; the results do not depend on it.

    It holds for who enters it and for what is begun in it, not for other threads of the program.

    Args:
        count: at least 1; None: as many as outside of it.
    """
    token = _said.set(_said.get() if count is None else count)
    try:
        yield
    finally:
        _said.reset(token)


def thread_count() -> int:
    """Over how many threads work is spread here: as `threads` says, or one a core."""
    return _said.get() or default_threads()


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max_workers=threads, thread_name_prefix="elbowroom")


def spread(work: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """Does `work` for each item on up to `thread_count()` threads and returns the results in order.

    The calling thread works as well, and nobody is woken for single items. After an error no further item is begun.
    """
    many = min(thread_count(), len(items))
    if many <= 1:
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

    others = [_pool(many - 1).submit(copy_context().run, go_on) for _ in range(many - 1)]
    try:
        go_on()
    finally:
        # those that have not begun have nothing left to do
        begun = [other for other in others if not other.cancel()]
        wait(begun)
    for other in begun:
        other.result()
    return [results[number] for number in range(len(items))]
