"""A decision in the words of a heartbeat, of a row, and of an operator."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from elbowroom.guard.heartbeat import PHASES, Heartbeat, Word
from elbowroom.guard.reason import Reason
from elbowroom.monitor.gate.state import Allowed, Decision, Rules
from elbowroom.monitor.result import CycleResult

AGAIN_S = 1.0
"""What is latched is said again after so long [s]."""


def heartbeat_of(decision: Decision, sequence: int, now_ns: int, trips_known: int, rules: Rules) -> Heartbeat:
    """What the watchdog is sent.

    Args:
        decision: of a pass.
        sequence: its number.
        now_ns: when it was finished [ns of `time.monotonic_ns`].
        trips_known: how many trips of the watchdog were heard of before.
        rules: of the run.
    """
    return Heartbeat(
        sequence,
        now_ns,
        rules.deadline_ns,
        PHASES.index(decision.phase.name.lower()),
        _word(decision.speed, decision.level.rank, decision.reason),
        tuple(_word_of(allowed) for allowed in decision.motions),
        decision.held_until_ns or 0,
        trips_known,
    )


def _word_of(allowed: Allowed) -> Word:
    return _word(allowed.speed, allowed.level.rank, allowed.reason, allowed.held, allowed.escapes)


def _word(speed: float, level: int, reason: Reason, held: bool = False, escapes: bool = False) -> Word:
    """Never faster than the speed: what is less than one per mille is stop."""
    per_mille = math.floor(1000 * speed)
    return Word(per_mille, level if per_mille else 0, reason, held and per_mille > 0, escapes)


def decision_row(decision: Decision) -> dict[str, Any]:
    """What `status` answers, and what a row of kind "gate" holds."""
    return {
        "phase": decision.phase.name.lower(),
        "level": decision.level.name.lower(),
        "speed": decision.speed,
        "reason": decision.reason.name.lower(),
        "sentence": decision.reason.sentence,
        "latched": [_fault_row(fault.reason, fault.subject, fault.sentence) for fault in decision.latched],
        "active": [_fault_row(fault.reason, fault.subject, fault.sentence) for fault in decision.active],
        "motions": {
            allowed.motion: {
                "level": allowed.level.name.lower(),
                "speed": allowed.speed,
                "reason": allowed.reason.name.lower(),
                "held": allowed.held,
                "escapes": allowed.escapes,
            }
            for allowed in decision.motions
        },
    }


def _fault_row(reason: Reason, subject: str, text: str) -> dict[str, str]:
    return {"reason": reason.name.lower(), "subject": subject, "text": text}


def gate_lines(decision: Decision) -> list[str]:
    """What an operator reads of a gate: where it stands, and each fault that is there, or that waits for a reset."""
    if not decision.latched:
        return [
            f"Gate: {decision.phase.value}; {decision.level.name.lower()}, {100 * decision.speed:.0f} % of full speed"
        ]
    over = [fault for fault in decision.latched if fault not in decision.active]
    lines = [f"Gate: stop, latched: {fault.sentence}" for fault in decision.active]
    return [*lines, *(f"Gate: stop until reset, this is over: {fault.sentence}" for fault in over)]


@dataclass(slots=True, eq=False)
class GateRows:
    """Rows of kind "gate": where the gate stands anew, and again each second while a fault is latched.

    Args:
        clock_s: the time [s].
    """

    clock_s: Callable[[], float] = time.monotonic
    _told: tuple[object, ...] = field(default=(), init=False)
    _told_s: float = field(default=float("-inf"), init=False)

    def rows(self, result: CycleResult, decision: Decision | None) -> list[dict[str, Any]]:
        """What is to be told of a pass.

        Args:
            result: of the pass.
            decision: what the gate made of it; None: there is no gate.
        """
        if decision is None:
            return []
        now_s = self.clock_s()
        now = decision.phase, decision.latched, decision.active, decision.level, decision.reason
        if now == self._told and not (decision.latched and now_s - self._told_s >= AGAIN_S):
            return []
        self._told, self._told_s = now, now_s
        shared = {"sequence": result.sequence, "time_s": result.stamp_ns / 1e9}
        return [{"kind": "gate", **shared, **decision_row(decision)}]
