"""Who does the tasks: this process, several on this computer, or a Dask cluster. The outcomes are the same."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import TypeVar

from elbowroom.errors import ElbowroomError, InputError
from elbowroom.evaluate.shares.task import Outcome, Task
from elbowroom.extras import package

Done = TypeVar("Done")
TRIES = 3
"""A task whose worker was lost is done again, so often at most."""


def do_tasks(
    tasks: Sequence[Task], *, jobs: int = 1, cluster: str | None = None
) -> Iterator[tuple[int, Outcome]]:
    """Does all tasks and yields each one's index and outcome as it is done.

    Args:
        tasks: in any order; those that come first are begun first.
        jobs: processes on this computer; 1: this process, with all its threads.
        cluster: address of a Dask scheduler, such as tcp://10.0.0.5:8786; None: this computer.

    Raises:
        InputError: no such scheduler, or fewer than one job.
        PackageError: Dask is not installed.
        ElbowroomError: a worker was lost more than three times.
    """
    if cluster is not None:
        yield from _on_cluster(tasks, cluster)
    else:
        yield from do_work([task.run for task in tasks], jobs=jobs)


def do_work(work: Sequence[Callable[[], Done]], *, jobs: int = 1) -> Iterator[tuple[int, Done]]:
    """Calls functions, and yields each one's index and what it gives as it is done.

    Args:
        work: functions that other processes find; those that come first are begun first.
        jobs: processes on this computer; 1: this process, with all its threads.

    Raises:
        InputError: fewer than one job.
        ElbowroomError: a worker was lost more than three times.
    """
    if jobs < 1:
        raise InputError(f"jobs: {jobs}, must be at least 1")
    if jobs == 1 or len(work) <= 1:
        for index, function in enumerate(work):
            yield index, function()
    else:
        yield from _on_processes(work, jobs)


def _on_processes(work: Sequence[Callable[[], Done]], jobs: int) -> Iterator[tuple[int, Done]]:
    left, lost = dict(enumerate(work)), 0
    while left:
        try:
            for index, done in _one_pool(left, jobs):
                del left[index]
                yield index, done
        except BrokenProcessPool as error:
            lost += 1
            if lost >= TRIES:
                raise ElbowroomError(
                    f"{lost} times a worker process was ended from outside, perhaps for want of memory; "
                    "run again with fewer jobs"
                ) from error


def _one_pool(left: dict[int, Callable[[], Done]], jobs: int) -> Iterator[tuple[int, Done]]:
    context = multiprocessing.get_context("spawn")
    number = context.Value("i", 0)
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_settle, initargs=(number, jobs))
    try:
        pending: dict[Future[Done], int] = {pool.submit(function): index for index, function in left.items()}
        while pending:
            done, _ = wait(pending, return_when=FIRST_COMPLETED)
            for future in sorted(done, key=lambda f: pending[f]):
                yield pending.pop(future), future.result()
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def _settle(number: "multiprocessing.sharedctypes.Synchronized[int]", jobs: int) -> None:
    """A worker takes its share of the cores and leaves Ctrl-C to the one who gave it work."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with number.get_lock():
        mine = number.value
        number.value += 1
    if hasattr(os, "sched_setaffinity"):
        cores = sorted(os.sched_getaffinity(0))
        first = mine % jobs * len(cores) // jobs
        count = max(1, len(cores) // jobs)
        os.sched_setaffinity(0, cores[first : first + count])


def _on_cluster(tasks: Sequence[Task], address: str) -> Iterator[tuple[int, Outcome]]:
    distributed = package("distributed")
    try:
        client = distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(f"cluster: no Dask scheduler answers at {address} ({error})") from error
    with client:
        # Dask itself gives the work of a lost worker to another
        futures = client.map(Task.run, list(tasks), pure=False, retries=TRIES - 1)
        index_of = {future.key: index for index, future in enumerate(futures)}
        for future in distributed.as_completed(futures):
            yield index_of[future.key], future.result()
