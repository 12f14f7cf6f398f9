"""Steps of longer work: a bar on a terminal, plain lines elsewhere."""

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

MANY = 40
"""So many pieces of a step are counted where there is no terminal."""


class Steps:
    """Shows which step of how many is being done. Use it as a context.

    Args:
        console: where to show it.
        count: number of steps.
    """

    def __init__(self, console: Console, count: int) -> None:
        self.console, self.count, self.done = console, count, 0
        self.seconds: dict[str, float] = {}
        self._begun: set[str] = set()
        self._current: tuple[str, float] | None = None
        columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        self._bar = Progress(*columns, console=console, transient=True) if console.is_terminal else None
        self._task = self._bar.add_task("", total=count) if self._bar else None

    def __enter__(self) -> "Steps":
        if self._bar:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end_step()
        if self._bar:
            self._bar.stop()

    def begin(self, what: str) -> None:
        """Ends the step before and begins the next one, such as "compiling kernels"."""
        self._end_step()
        self._current = (what, time.perf_counter())
        if self._bar and self._task is not None:
            self._bar.update(self._task, description=f"{what} ...", completed=self.done)
        else:
            self.console.print(f"{what} ...", highlight=False)
        self.done += 1

    def begin_once(self, what: str) -> None:
        """As `begin`, but nothing where this step was begun before: for work that goes round in rounds."""
        if what not in self._begun:
            self._begun.add(what)
            self.begin(what)

    def counted(self, done: int, of: int) -> None:
        """Says how much of the step is done: beside it on a terminal, elsewhere a line for every quarter of much."""
        if self._current is None:
            return
        words = f"{self._current[0]}: {done} of {of}"
        if self._bar and self._task is not None:
            self._bar.update(self._task, description=words)
        elif of >= MANY and done * 4 // of > (done - 1) * 4 // of:
            self.console.print(words, highlight=False)

    def _end_step(self) -> None:
        if self._current is not None:
            what, start = self._current
            self.seconds[what] = time.perf_counter() - start
            self._current = None
