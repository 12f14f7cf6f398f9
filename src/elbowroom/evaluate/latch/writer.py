"""The process that is killed: a gate with faults and resets at random, that says in a journal what it has done."""

import os
import random
import socket
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path

from elbowroom.evaluate.latch.journal import ASKED, BEGUN, ENDED, ENDING, FAULT, REFUSED, RESET
from elbowroom.guard.control import NAME
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Rules
from elbowroom.monitor.result import CycleResult
from elbowroom.motion import Cause, Level, Motion, Verdict

SITE = "evaluate latch"
MOTIONS = (Motion("slide", +1, 0.1), Motion("slide", -1, 0.1))
RULES = Rules(tuple(motion.name for motion in MOTIONS))
VERDICTS = tuple(Verdict(motion, Level.CLEAR, 0.5, "m", None, None, Cause.NONE) for motion in MOTIONS)
PASS_NS = 50_000_000
WRONG = ({"fault": "KeyError: 'x'"}, {"late": "the oldest image is 300 ms old"})
MOST_PASSES = 12


def write_for_ever(folder: Path, seed: int, say: Callable[[str], None]) -> None:
    """Runs a gate, ends it, and so on, until this process is killed.

    Args:
        folder: of the gate.
        seed: of what happens.
        say: takes lines of the journal; what it was told outlives this process.
    """
    chance = random.Random(seed)
    while True:
        ticks = count(1_000_000_000, PASS_NS // 4)
        gate = Gate(folder, SITE, RULES, None, lambda ticks=ticks: next(ticks))  # type: ignore[misc]
        gate.begin()
        say(BEGUN)
        for sequence in range(chance.randint(1, MOST_PASSES)):
            _pass(gate, folder, sequence, chance, say)
        say(ENDING)
        gate.end()
        say(ENDED)


def _pass(gate: Gate, folder: Path, sequence: int, chance: random.Random, say: Callable[[str], None]) -> None:
    """One pass: now and then with a fault, now and then with a person who asks for a reset."""
    wrong = chance.choice(WRONG) if chance.random() < 0.2 else {}
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as person:
        asks = chance.random() < 0.5
        if asks:
            person.connect(os.fspath(folder / NAME))
            person.sendall(b"reset\n")
            say(ASKED)
        result = CycleResult(
            sequence, 0, None, VERDICTS, {}, None, wrong.get("fault"), late=wrong.get("late")
        )
        decision = gate.decide(result)
        if asks:
            person.setblocking(False)
            with suppress(BlockingIOError):
                say(RESET if b'"reset": true' in person.recv(65536) else REFUSED)
    for fault in decision.active:
        say(f"{FAULT} {fault.reason.name}")
