"""Whether verdicts of a recording are the same to the last bit: in other processes, with other threads, other code."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.recording.sample import record_cell, record_sample
from elbowroom.files.progress import Progress, silent

DUE = (Due("different", "≤", 0, words="cycles with a verdict that is another"),)
"""Of 10,000 cycles, each way."""
WAYS: tuple[tuple[str, int, Mapping[str, str]], ...] = (
    ("another process, one thread", 1, {}),
    ("another process, two threads", 2, {}),
    ("code for any x86-64, one thread", 1, {"NUMBA_CPU_NAME": "generic"}),
    ("code for any x86-64, two threads", 2, {"NUMBA_CPU_NAME": "generic"}),
)
"""Words, threads, and what stands in the environment."""
ROOMS: tuple[tuple[str, int, Callable[..., Path]], ...] = (
    ("a box that slides", 1, record_cell),
    ("the simulated room", 10, record_sample),
)
"""Words, of how many cycles one is recorded, and how. A pass of the room with its C-arm takes ten times as long."""


def again_rows(cycles: int = 10_000, seed: int = 1, tell: Progress = silent) -> Iterator[dict[str, Any]]:
    """A row for each way to judge a recording again, of each room.

    Args:
        cycles: how many a recording of the cell has; that of the room has a tenth of them.
        seed: of the noise, and of what goes wrong in the run.
        tell: told what is being done.

    Raises:
        ElbowroomError: a process came to nothing.
    """
    for room, share, record in ROOMS:
        yield from _rows_of(room, max(1, cycles // share), partial(record, seed=seed), tell)


def _rows_of(
    room: str, cycles: int, record: Callable[[Path, int], Path], tell: Progress
) -> Iterator[dict[str, Any]]:
    with TemporaryDirectory() as folder:
        tell(f"{room}: recording {cycles} cycles")
        file = record(Path(folder) / "run.mcap", cycles)
        for words, threads, environment in WAYS:
            tell(f"{room}, {words}: judging again")
            begun = time.perf_counter()
            rows = _replayed(file, threads, environment)
            yield {
                "room": room,
                "way": words,
                "cycles": len(rows),
                "verdicts": sum(row["verdicts"] for row in rows),
                "different": cycles - sum(row["identical"] for row in rows),
                "first": next((row["differences"][0] for row in rows if row["differences"]), None),
                "seconds": time.perf_counter() - begun,
            }


def _replayed(file: Path, threads: int, environment: Mapping[str, str]) -> Sequence[dict[str, Any]]:
    """Rows of `elbowroom replay` of a process of its own."""
    out = file.with_suffix(".json")
    words = [sys.executable, "-m", "elbowroom", "replay", str(file)]
    words += ["--threads", str(threads), "--json", str(out)]
    done = subprocess.run(words, env={**os.environ, **environment}, capture_output=True, text=True)
    if done.returncode not in (0, 1) or not out.exists():
        raise ElbowroomError(
            f"evaluate replay: the process ended with {done.returncode}: {done.stderr[-300:]}"
        )
    rows = json.loads(out.read_text(encoding="utf-8"))["rows"]
    out.unlink()
    return [row for row in rows if row["kind"] == "cycle"]
