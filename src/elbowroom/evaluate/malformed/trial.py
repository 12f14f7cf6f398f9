"""One reader, tried with one input after the other: what it should not do is kept, once for each place."""

import json
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elbowroom.evaluate.malformed.targets import LEAST_LIMIT, Target, quietly

SLOW_S = 2.0
"""Processor time that no input of these lengths may take [s]."""
FINDINGS = "findings.jsonl"
TIMES = 2
"""So many times the limit may be taken."""


@dataclass(slots=True, eq=False)
class Trial:
    """Tries inputs.

    Args:
        target: that reads.
        folder: for what is found.
        scratch: for files that are read.
    """

    target: Target
    folder: Path
    scratch: Path
    runs: int = field(default=0, init=False)
    found: Counter[str] = field(default_factory=Counter, init=False)

    def one(self, data: bytes) -> None:
        """Tries an input."""
        begun = time.process_time()
        try:
            quietly(self.target, data, self.scratch)
        except MemoryError as error:
            self._keep("allocation", error, data)
        except Exception as error:
            self._keep("crash", error, data)
        self.runs += 1
        spent = time.process_time() - begun
        if spent > SLOW_S:
            self._keep("slow", TimeoutError(f"{spent:.1f} s"), data)

    def _keep(self, kind: str, error: BaseException, data: bytes) -> None:
        """Keeps the first input of each place."""
        where = place_of(error)
        key = f"{kind} {type(error).__name__} {where}"
        self.found[key] += 1
        if self.found[key] > 1:
            return
        name = f"{self.target.name.replace(' ', '-')}-{kind}-{len(self.found)}"
        (self.folder / name).write_bytes(data)
        row: dict[str, Any] = {
            "kind": kind,
            "where": where,
            "error": f"{type(error).__name__}: {error}"[:300],
        }
        with (self.folder / FINDINGS).open("a", encoding="utf-8") as file:
            file.write(json.dumps({**row, "input": name}) + "\n")


def place_of(error: BaseException) -> str:
    """The last line of this package, or else the last line, that an error came through."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [
        frame
        for frame in frames
        if "elbowroom" in Path(frame.filename).parts and "malformed" not in Path(frame.filename).parts
    ]
    if not frames:
        return ""
    last = (own or frames)[-1]
    return f"{'/'.join(Path(last.filename).parts[-3:])}:{last.lineno}"


def hold_memory(target: Target) -> None:
    """From here on this process gets `TIMES` the limit of a target more than it has, and then a `MemoryError`."""
    import resource

    has = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    most = has + TIMES * max(target.limit, LEAST_LIMIT)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
