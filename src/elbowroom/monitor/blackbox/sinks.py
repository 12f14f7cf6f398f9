"""Where passes go that are kept: one file of a whole run, or a file for each stop, of the minute before it."""

import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from elbowroom.monitor.blackbox.behind import BehindFile
from elbowroom.monitor.blackbox.kept_pass import KeptFrame, KeptPass
from elbowroom.monitor.blackbox.pass_file import Head


class Sink(Protocol):
    """Takes passes, in a thread of its own. It may raise `OSError`: that is told, and not the end of it."""

    @property
    def trouble(self) -> str | None:
        """What is not kept, and why; None: all is."""

    def begin(self, head: Head) -> None:
        """A run begins."""

    def take(self, one: KeptPass) -> None:
        """The next pass."""

    def work(self) -> bool:
        """Does a little of what is left to do; whether there was something."""

    def end(self) -> None:
        """There will be no more passes; all that is left is done."""

    @property
    def said(self) -> list[str]:
        """What was written, a line each."""

    @property
    def busy_ns(self) -> int:
        """Processor time that threads of its own have taken [ns]."""


@dataclass(slots=True, eq=False)
class WholeRun:
    """A file of all passes.

    Args:
        path: of a file that is not there yet.
    """

    path: Path
    trouble: str | None = field(default=None, init=False)
    said: list[str] = field(default_factory=list, init=False)
    _file: BehindFile | None = field(default=None, init=False)
    _spent_ns: int = field(default=0, init=False)

    @property
    def busy_ns(self) -> int:
        """Processor time that the file's thread has taken [ns]."""
        return self._spent_ns if self._file is None else self._file.busy_ns

    def begin(self, head: Head) -> None:
        """Begins the file."""
        self._file = BehindFile(self.path, head)

    def take(self, one: KeptPass) -> None:
        """Writes the pass. A file that could not be written is left as it is, and no more is added."""
        self._guarded(lambda file: file.add(one))

    def work(self) -> bool:
        """Nothing is left, but to say what went wrong."""
        self._guarded(BehindFile.check)
        return False

    def end(self) -> None:
        """Ends the file."""
        self._guarded(lambda file: self.said.append(file.end()))
        self._spent_ns, self._file = self.busy_ns, None

    def _guarded(self, what: Callable[[BehindFile], None]) -> None:
        """Does something with the file, if there is one still."""
        if self._file is None:
            return
        try:
            what(self._file)
        except OSError as error:
            passes, self._spent_ns, self._file = self._file.passes, self.busy_ns, None
            self.trouble = f"{self.path}: {why(error)}; it ends after {passes} passes"


@dataclass(slots=True, eq=False)
class BlackBox:
    """The last passes in memory; each stop leaves a file of what was before it and a while after.

    Another stop before that while is over makes the same file longer. What is left to write is written while no pass
    waits to be kept.

    Args:
        folder: of the files.
        before_ns, after_ns: how much is kept of a stop [ns].
        most_bytes: of passes in memory; those that came first are let go.
        clock_ns: by which passes are heard.
    """

    folder: Path
    before_ns: int = 60_000_000_000
    after_ns: int = 10_000_000_000
    most_bytes: int = 6_000_000_000
    clock_ns: Callable[[], int] = time.monotonic_ns
    _trouble: str | None = field(default=None, init=False)
    _short_ns: int | None = field(default=None, init=False)
    said: list[str] = field(default_factory=list, init=False)
    _head: Head | None = field(default=None, init=False)
    _kept: deque[KeptPass] = field(default_factory=deque, init=False)
    _size: int = field(default=0, init=False)
    _users: dict[int, int] = field(default_factory=dict, init=False)
    _file: BehindFile | None = field(default=None, init=False)
    _waiting: deque[KeptPass] = field(default_factory=deque, init=False)
    _until_ns: int = field(default=0, init=False)
    _is_over: bool = field(default=False, init=False)
    _spent_ns: int = field(default=0, init=False)

    @property
    def busy_ns(self) -> int:
        """Processor time that threads of its files have taken [ns]."""
        return self._spent_ns + (0 if self._file is None else self._file.busy_ns)

    @property
    def trouble(self) -> str | None:
        """That a stop is not kept, or that memory does not hold as much as it should; None: neither."""
        if self._trouble is not None or self._short_ns is None:
            return self._trouble
        return (
            f"{self.folder}: {self.most_bytes / 1e6:g} MB of memory hold {self._short_ns / 1e9:.1f} s before a stop, "
            f"not {self.before_ns / 1e9:g} (black_box.memory_mb)"
        )

    def begin(self, head: Head) -> None:
        """Nothing is written before a stop."""
        self._head = head

    def take(self, one: KeptPass) -> None:
        """Keeps the pass; begins a file if something stopped with it."""
        self._hold(one)
        if self._file is not None:
            self._waiting.append(one)
        elif one.stops:
            self._begin_file(one)
        if one.stops:
            self._until_ns = one.heard_ns + self.after_ns
        self.work()

    def work(self) -> bool:
        """Writes one pass of those that wait, or ends the file."""
        if self._file is None:
            return False
        try:
            if self._waiting:
                self._file.add(self._waiting.popleft())
                return True
            self._file.check()
            if not self._is_over and self.clock_ns() < self._until_ns:
                return False
            self._end_file()
        except OSError as error:
            self._give_up(self._file.path, error)
        return True

    def end(self) -> None:
        """Writes what waits."""
        self._is_over = True
        while self.work():
            pass

    def _hold(self, one: KeptPass) -> None:
        """Keeps a pass in memory, and lets go of those that are too old, or too many."""
        self._kept.append(one)
        self._size += one.own_size + sum(self._used(frame, +1) for frame in one.frames)
        while len(self._kept) > 1 and (
            self._size > self.most_bytes or one.heard_ns - self._kept[0].heard_ns > self.before_ns
        ):
            old = self._kept.popleft()
            held_ns = one.heard_ns - self._kept[0].heard_ns
            if self._size > self.most_bytes and held_ns < self.before_ns:
                self._short_ns = held_ns
            self._size -= old.own_size + sum(self._used(frame, -1) for frame in old.frames)

    def _used(self, frame: KeptFrame, more: int) -> int:
        """By how much a frame counts where one more, or one less, pass holds it [bytes]."""
        before = self._users.get(id(frame), 0)
        now = before + more
        if now:
            self._users[id(frame)] = now
        else:
            del self._users[id(frame)]
        return len(frame.told.data) if 0 in (before, now) else 0

    def _begin_file(self, one: KeptPass) -> None:
        assert self._head is not None
        day = time.strftime("%Y%m%dT%H%M%SZ", time.gmtime(one.wall_ns / 1e9))
        path = self.folder / f"stop-{day}-{one.sequence}.mcap"
        try:
            self._file = BehindFile(path, self._head)
            self._waiting = deque(self._kept)
        except OSError as error:
            self._give_up(path, error)

    def _end_file(self) -> None:
        assert self._file is not None
        said = self._file.end()
        self._spent_ns += self._file.busy_ns
        self._file, self._trouble = None, None
        self.said.append(said)

    def _give_up(self, path: Path, error: OSError) -> None:
        self._trouble = f"{path}: {why(error)}; this stop is not kept, or not all of it"
        self._spent_ns, self._file = self.busy_ns, None
        self._waiting.clear()


def why(error: OSError) -> str:
    """What the system says of a file that cannot be written."""
    with suppress(AttributeError):
        return f"cannot be written ({error.strerror})"
    return "cannot be written"
