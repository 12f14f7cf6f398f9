"""A small process that starts gates, kills them at random moments, and reads what is left: a line of JSON for each.

python -m elbowroom.evaluate.latch.killing FOLDER COUNT SEED
"""

import json
import os
import random
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from elbowroom.evaluate.latch.journal import is_kept, is_named, truth_after
from elbowroom.evaluate.latch.writer import SITE, write_for_ever
from elbowroom.guard.fault import Fault
from elbowroom.guard.latch import NAME, read_latch

MOST_S = 0.06
"""A gate lives so long at most [s], and half of that on average."""


def kills(folder: Path, many: int, seed: int) -> Iterator[dict[str, Any]]:
    """What each kill left, one after the other in one folder.

    Args:
        folder: of the gate.
        many: how often.
        seed: of the moments, and of what happens.
    """
    chance = random.Random(seed)
    before = read_latch(folder / NAME, SITE).faults
    for number in range(many):
        lines = _killed(folder, chance.random() * MOST_S, seed * 1_000_003 + number)
        left = (folder / f".{NAME}.unfinished").exists()
        kept = read_latch(folder / NAME, SITE).faults
        yield row_of(before, lines, kept) | {"inside_a_write": left}
        before = kept


def row_of(before: tuple[Fault, ...], lines: list[str], kept: tuple[Fault, ...]) -> dict[str, Any]:
    """What one kill comes to.

    Args:
        before: what was latched before.
        lines: of the journal.
        kept: what was read after.
    """
    truth = truth_after(before, lines)
    while "ended" in lines:
        # runs that have ended are over: the next begins with what they left
        at = lines.index("ended") + 1
        over, lines = truth_after(before, lines[:at]), lines[at:]
        before = tuple(Fault(reason) for reason in over.latched)
        truth = truth_after(before, lines) if lines else over
    return {
        "lines": len(lines),
        "latched": sorted(reason.name for reason in truth.latched),
        "kept": is_kept(truth, kept),
        "named": is_named(truth, kept),
        "unlatched": not kept,
    }


def _killed(folder: Path, after_s: float, seed: int) -> list[str]:
    """The journal of a gate that was killed."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        write_for_ever(folder, seed, lambda line: _say(writing, line))
    os.close(writing)
    time.sleep(after_s)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    with os.fdopen(reading, "rb") as file:
        *lines, _ = file.read().decode().split("\n")
    return lines


def _say(writing: int, line: str) -> None:
    os.write(writing, line.encode() + b"\n")


def main() -> None:
    """Writes a line of JSON for each kill."""
    folder, many, seed = sys.argv[1:]
    for row in kills(Path(folder), int(many), int(seed)):
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
