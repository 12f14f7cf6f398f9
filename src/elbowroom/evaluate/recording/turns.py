"""A whole run in files one after the other, of which each is looked at and gone when the next is full.

At full rate half an hour is more than a hundred gigabytes; so much no disk has to have free to be measured.
"""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from elbowroom.monitor.blackbox.kept_pass import KeptPass
from elbowroom.monitor.blackbox.pass_file import Head
from elbowroom.monitor.blackbox.sinks import WholeRun


@dataclass(slots=True, eq=False)
class InTurns:
    """Takes passes as `WholeRun` does, and begins another file every so often.

    Args:
        folder: of the files.
        turn_ns: how long each is.
        done: told each file that is whole; it does not wait.
    """

    folder: Path
    turn_ns: int
    done: Callable[[Path], None]
    trouble: str | None = field(default=None, init=False)
    said: list[str] = field(default_factory=list, init=False)
    files: int = field(default=0, init=False)
    bytes: int = field(default=0, init=False)
    _head: Head | None = field(default=None, init=False)
    _turn: WholeRun | None = field(default=None, init=False)
    _begun_ns: int = field(default=0, init=False)
    _ending: list[threading.Thread] = field(default_factory=list, init=False)
    _spent_ns: int = field(default=0, init=False)

    def begin(self, head: Head) -> None:
        """Remembers what each file begins with."""
        self._head = head

    def take(self, one: KeptPass) -> None:
        """Writes the pass."""
        assert self._head is not None
        if self._turn is not None and one.heard_ns - self._begun_ns >= self.turn_ns:
            self._turn_over()
        if self._turn is None:
            self._turn, self._begun_ns = WholeRun(self.folder / f"run-{self.files}.mcap"), one.heard_ns
            self._turn.begin(self._head)
            self.files += 1
        self._turn.take(one)
        self.trouble = self.trouble or self._turn.trouble

    def work(self) -> bool:
        """Nothing is left."""
        return False

    def end(self) -> None:
        """Ends the file that is open, and waits until it is on the disk."""
        self._turn_over()
        for each in self._ending:
            each.join()

    @property
    def busy_ns(self) -> int:
        """Processor time that threads of all files have taken [ns]."""
        return self._spent_ns + (0 if self._turn is None else self._turn.busy_ns)

    def _turn_over(self) -> None:
        """Lets the open file be ended beside the run, as that of a whole run is after it."""
        if self._turn is None:
            return
        ending = threading.Thread(target=self._ended, args=(self._turn,))
        self._ending = [*(each for each in self._ending if each.is_alive()), ending]
        self._turn = None
        ending.start()

    def _ended(self, turn: WholeRun) -> None:
        turn.end()
        self.trouble = self.trouble or turn.trouble
        self.bytes += turn.path.stat().st_size
        self._spent_ns += turn.busy_ns + time.thread_time_ns()
        self.done(turn.path)
