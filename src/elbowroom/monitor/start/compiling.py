"""Compiles what a run needs before it begins: on all cores, and seen to be doing it."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractContextManager, nullcontext
from threading import Condition

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.spinner import Spinner
from rich.table import Table
from rich.text import Text

from elbowroom._kernel_cache import only_one
from elbowroom.geometry.parallel import default_threads
from elbowroom.monitor.start.kernel_jobs import JOBS, Job

WORKER = (sys.executable, "-m", "elbowroom.monitor.start.kernel_jobs")


def compile_kernels(console: Console, *, machine: bool, motion: bool, simulator: bool) -> None:
    """Compiles those kernels of a run that the cache on disk does not have, and shows which.

    What fails here is compiled again, and its fault shown, when the run comes to use it.

    Args:
        console: where to show it.
        machine: whether the run has a machine.
        motion: whether it checks motions.
        simulator: whether its images are simulated.
    """
    given = {"always": True, "machine": machine, "motion": motion, "simulator": simulator}
    wanted = [job for job in JOBS if given[job.needs] and not job.is_kept]
    if not wanted:
        return
    # of two processes that start at once one compiles, and the other one takes what that has kept
    with only_one("compiles kernels"):
        wanted = [job for job in wanted if not job.is_kept]
        if wanted:
            _compile(console, wanted)


def _compile(console: Console, wanted: Sequence[Job]) -> None:
    """Does jobs, and shows which."""
    board = _Board(wanted)
    if console.is_terminal:
        shown: AbstractContextManager[object] = Live(
            board, console=console, transient=True, refresh_per_second=8
        )
    else:
        console.print(board.headline, highlight=False, soft_wrap=True)
        shown = nullcontext()
    with shown:
        run_jobs(wanted, default_threads(), board.tell)


def run_jobs(
    jobs: Sequence[Job],
    workers: int,
    tell: Callable[[str, str], None],
    command: Sequence[str] = WORKER,
) -> None:
    """Does jobs in processes of their own, each as soon as what it comes after is done.

    Args:
        jobs: in the order in which to begin them.
        workers: how many processes at once.
        tell: called with a job's name and "begun", "done" or "failed", from any thread.
        command: of a process that does jobs as `kernel_jobs` does.
    """
    queue = _Queue(jobs)
    processes: list[subprocess.Popen[str]] = []

    def work() -> None:
        process = _worker(command)
        processes.append(process)
        alive = True
        while (job := queue.next()) is not None:
            if alive:
                tell(job.name, "begun")
                alive = _done_by(process, job)
            tell(job.name, "done" if alive else "failed")
            queue.finished(job)
        process.communicate()

    many = min(workers, len(jobs))
    pool = ThreadPoolExecutor(many)
    try:
        for future in [pool.submit(work) for _ in range(many)]:
            future.result()
    finally:
        queue.close()
        for process in processes:
            process.kill()
        pool.shutdown()


class _Queue:
    """Jobs that wait, for several threads: each is given once, as soon as what it comes after is finished."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        self._waiting, self._unfinished = list(jobs), {job.name for job in jobs}
        self._change = Condition()

    def next(self) -> Job | None:
        """The next one; waits while all that are left come after another. None: there are no more."""
        with self._change:
            while self._waiting:
                for job in self._waiting:
                    if job.after not in self._unfinished:
                        self._waiting.remove(job)
                        return job
                self._change.wait()
            return None

    def finished(self, job: Job) -> None:
        with self._change:
            self._unfinished.discard(job.name)
            self._change.notify_all()

    def close(self) -> None:
        """Gives no more."""
        with self._change:
            self._waiting.clear()
            self._change.notify_all()


def _worker(command: Sequence[str]) -> "subprocess.Popen[str]":
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True, bufsize=1)


def _done_by(process: "subprocess.Popen[str]", job: Job) -> bool:
    assert process.stdin is not None and process.stdout is not None
    try:
        process.stdin.write(f"{job.name}\n")
        process.stdin.flush()
        return process.stdout.readline().strip() == job.name
    except OSError:
        return False


class _Board:
    """The jobs as a table that moves: done, being compiled, waiting."""

    def __init__(self, jobs: Sequence[Job]) -> None:
        self._state = {job.name: "waiting" for job in jobs}
        self._spinner = Spinner("dots")

    def tell(self, name: str, state: str) -> None:
        self._state[name] = state

    @property
    def headline(self) -> str:
        done = sum(state in ("done", "failed") for state in self._state.values())
        return (
            f"Compiling for this processor, at the first start only: {done} of {len(self._state)} parts done"
        )

    def __rich__(self) -> RenderableType:
        table = Table.grid(padding=(0, 1))
        marks: dict[str, RenderableType] = {
            "waiting": Text("·", style="dim"),
            "begun": self._spinner,
            "done": Text("✓", style="green"),
            "failed": Text("!", style="red"),
        }
        for name, state in self._state.items():
            table.add_row(marks[state], Text(name, style="dim" if state == "waiting" else ""))
        return Group(Text(self.headline), table)
