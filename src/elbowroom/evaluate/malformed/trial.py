"""One reader, tried with one input after the other: what it should not do is kept, once for each place."""

import json
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from elbowroom.evaluate.malformed.targets import LEAST_LIMIT, Target, quietly

SLOW_S = 2.0
"""Processor time that no input of these lengths may take [s]; twice, as a first one may load a module as well."""
STATM = Path("/proc/self/statm")
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
        holds: whether a reader gets no more than `TIMES` its limit; needs Linux.
    """

    target: Target
    folder: Path
    scratch: Path
    holds: bool = False
    runs: int = field(default=0, init=False)
    found: Counter[str] = field(default_factory=Counter, init=False)

    def one(self, data: bytes) -> None:
        """Tries an input."""
        self.runs += 1
        spent_s = self._try(data)
        if spent_s > SLOW_S:
            spent_s = min(spent_s, self._try(data))
        if spent_s > SLOW_S:
            self._keep("slow", TimeoutError(f"{spent_s:.1f} s"), data)

    def _try(self, data: bytes) -> float:
        """Tries an input; gives the processor time that it took [s]."""
        begun_s = time.process_time()
        try:
            with memory_held(self.target) if self.holds else nullcontext():
                quietly(self.target, data, self.scratch)
        except MemoryError as error:
            self._keep("allocation", error, data)
        except Exception as error:
            self._keep("crash", error, data)
        return time.process_time() - begun_s

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


@contextmanager
def memory_held(target: Target) -> Iterator[None]:
    """Within, this process gets `TIMES` the limit of a target more than it has, and then a `MemoryError`.

    What it takes outside of it, such as libFuzzer for the inputs that it keeps, is no matter.
    """
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    with STATM.open("rb", buffering=0) as file:
        has = int(file.read(64).split()[0]) * resource.getpagesize()
    most = has + TIMES * max(target.limit, LEAST_LIMIT)
    if hard != resource.RLIM_INFINITY:
        most = min(most, hard)
    resource.setrlimit(resource.RLIMIT_AS, (most, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
