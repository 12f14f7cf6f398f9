"""The gate of a run, the one place that remembers: it asks the step what to say, keeps the latch, tells who listens."""

import fcntl
import os
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError
from elbowroom.files.atomic import folder as made_folder
from elbowroom.guard.control import Control
from elbowroom.guard.fault import Fault
from elbowroom.guard.latch_file import LatchFile
from elbowroom.guard.link import WatchdogLink
from elbowroom.guard.reason import Reason
from elbowroom.monitor.gate.claim import claims_of, held_back
from elbowroom.monitor.gate.faults import faults_of
from elbowroom.monitor.gate.state import (
    Decision,
    Ended,
    Event,
    GateState,
    Held,
    Judged,
    ResetAsked,
    Rules,
    Ticked,
)
from elbowroom.monitor.gate.step import step
from elbowroom.monitor.gate.told import decision_row, heartbeat_of
from elbowroom.monitor.result import CycleResult


@dataclass(slots=True, eq=False)
class Gate:
    """Decides after each pass. Whatever fails in it is a stop that latches; what is wrong before it begins is raised.

    Args:
        folder: of the latch and the controls; made if it is not there.
        site: what the latch is of.
        rules: of the run.
        watchdog: is told each decision; None: nobody is told outside this process.
        clock_ns: one for all processes of this computer, that never goes back [ns].
    """

    folder: Path
    site: str
    rules: Rules
    watchdog: WatchdogLink | None = None
    clock_ns: Callable[[], int] = time.monotonic_ns
    _state: GateState = field(init=False)
    _decision: Decision = field(init=False)
    _latch: LatchFile = field(init=False)
    _control: Control = field(init=False)
    _lock: int | None = field(default=None, init=False)
    _sequence: int = field(default=0, init=False)
    _is_broken: bool = field(default=False, init=False)

    def begin(self) -> None:
        """Takes the folder and what its latch holds, and starts the watchdog. The machine is stop.

        Raises:
            InputError: the folder cannot be used, or another monitor runs with it.
        """
        made_folder(self.folder)
        self._lock = _locked(self.folder)
        try:
            self._control = Control(self.folder)
        except InputError:
            self._let_go()
            raise
        self._latch = LatchFile(self.folder, self.site)
        self._state = GateState.start(self.rules, self._latch.begin())
        self._latch.keep(self._state.latched, self.clock_ns())
        if self.watchdog is not None:
            self.watchdog.begin()
        self._decision = self._stepped(Ticked())

    def decide(self, result: CycleResult) -> Decision:
        """What a pass comes to: said to the watchdog, then kept, then what was asked is answered. It does not raise."""
        self._sequence = max(result.sequence, self._sequence + 1)
        asked = self._asked()
        try:
            claims = held_back(claims_of(result.verdicts, self.rules.low_speed), result.sick)
            self._pass(Judged(claims, faults_of(result)))
        except Exception as error:  # whatever fails here is a stop
            self._is_broken = True  # until that stop is latched, this run cannot have ended well
            self._pass(Judged((), (Fault(Reason.FAULT, "gate", f"{type(error).__name__}: {error}"),)))
            self._is_broken = False
        for request, answer in asked:
            self._answer(request, answer)
        return self._decision

    def end(self) -> None:
        """Says stop for good. Where nothing is latched, the latch says that this run has ended as it was asked to; not
        where a stop could not be latched: that reads as killed.
        """
        latched = self._state.latched
        self._sequence += 1
        self._decision = self._stepped(Ended())
        self._send()
        if self.watchdog is not None:
            self.watchdog.end()
        if not self._is_broken:
            self._latch.end(latched)
        self._control.end()
        self._let_go()

    def _let_go(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _pass(self, judged: Judged) -> None:
        """A pass, with what is wrong beside it. A stop is said before it is written: the disk says latched anyway."""
        beside = [] if self.watchdog is None else self.watchdog.faults()
        self._decision = self._stepped(self._with(judged, beside))
        self._send()
        self._latch.keep(self._state.latched, self.clock_ns())
        if self._latch.fault is not None and self._latch.fault not in self._state.active:
            self._decision = self._stepped(self._with(judged, beside))
            self._sequence += 1
            self._send()

    def _with(self, judged: Judged, beside: list[Fault]) -> Judged:
        """A pass with the faults of what carries its word."""
        latch = [] if self._latch.fault is None else [self._latch.fault]
        return Judged(judged.claims, (*judged.faults, *beside, *latch))

    def _stepped(self, event: Event) -> Decision:
        self._state, decision = step(self._state, event, self.clock_ns(), self.rules)
        return decision

    def _send(self) -> None:
        if self.watchdog is None:
            return
        now_ns, trips = self.clock_ns(), self.watchdog.trips
        self.watchdog.send(heartbeat_of(self._decision, self._sequence, now_ns, trips, self.rules))

    def _asked(self) -> list[tuple[str, Callable[[Mapping[str, Any]], None]]]:
        """What was asked since the last pass, without held signals: these are heard before it."""
        left: list[tuple[str, Callable[[Mapping[str, Any]], None]]] = []
        with suppress(Exception):  # who asks wrongly moves nothing and stops nothing
            for request, answer in self._control.requests():
                word, _, when = request.partition(" ")
                if word != "hold":
                    left.append((request, answer))
                    continue
                is_now = when.isdecimal() and 0 <= self.clock_ns() - int(when) <= self.rules.hold_ns
                if is_now:
                    self._stepped(Held())
                answer({"held": is_now})
        return left

    def _answer(self, request: str, answer: Callable[[Mapping[str, Any]], None]) -> None:
        """Does and answers what was asked; a reset is kept on disk before it is said to be done."""
        if request == "reset":
            decision = self._stepped(ResetAsked())
            self._latch.keep(self._state.latched, self.clock_ns())
            self._decision = decision
            answer({**self._row(), "answer": decision.answer, "reset": decision.is_reset})
        elif request == "status":
            answer(self._row())
        else:
            answer({"answer": "refused: status, reset, or hold with a time"})

    def _row(self) -> dict[str, Any]:
        outputs = () if self.watchdog is None else self.watchdog.outputs
        return {**decision_row(self._decision), "site": self.site, "outputs": outputs}


def _locked(folder: Path) -> int:
    """Takes the folder for this process; the system lets it go when this process ends, however that is.

    Raises:
        InputError: another monitor has it, or it cannot be taken.
    """
    path = folder / "lock"
    try:
        lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror})") from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(lock)
        raise InputError(f"{folder}: another monitor runs with this gate") from None
    return lock
