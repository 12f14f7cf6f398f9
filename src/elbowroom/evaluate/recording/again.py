"""Whether verdicts of a recording are the same to the last bit: in other processes, with other threads, other code."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from elbowroom.errors import ElbowroomError
from elbowroom.evaluate.due import Due
from elbowroom.evaluate.recording.sample import record_sample
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


def again_rows(cycles: int = 10_000, seed: int = 1, tell: Progress = silent) -> Iterator[dict[str, Any]]:
    """A row for each way to judge a recording again.

    Args:
        cycles: how many it has.
        seed: of the noise, and of what goes wrong in the run.
        tell: told what is being done.

    Raises:
        ElbowroomError: a process came to nothing.
    """
    with TemporaryDirectory() as folder:
        tell(f"recording {cycles} cycles")
        file = record_sample(Path(folder) / "run.mcap", cycles, seed)
        for words, threads, environment in WAYS:
            tell(f"{words}: judging again")
            begun = time.perf_counter()
            rows = _replayed(file, threads, environment)
            yield {
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
