"""How long a new process takes to its first answer, kernels being compiled and kept before."""

import itertools
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import Due, Row

HERE = Path(__file__).resolve().parents[3]
"""Where this package lies."""
SCRIPT = Path(__file__).with_name("start_case.py")
FIRST, FIRST_WITH_MACHINE = "first call of er.reconstruct", "first call with the C-arm"
FIRST_OF_README = "first call of the README's example"
CASES = {
    "import elbowroom": ("alone", "import"),
    FIRST: ("alone", "first"),
    FIRST_WITH_MACHINE: ("machine", "first"),
    FIRST_OF_README: ("readme", "first"),
    "import to the first answer": ("alone", "to_answer"),
    "import to the first answer with the C-arm": ("machine", "to_answer"),
    "second call": ("alone", "second"),
    "second call with the C-arm": ("machine", "second"),
}
"""What is timed: how the script is called, and which of its times it is."""
SHARE = 3
"""A first call is due in this part of the time that it took before."""


def _third(row: Row) -> float:
    return float(row["before_ms"]) / SHARE


def _is_first(row: Row) -> bool:
    return row["case"] in (FIRST, FIRST_WITH_MACHINE, FIRST_OF_README) and row.get("before_ms") is not None


DUE = (Due("median_ms", "≤", _third, _is_first),)


def start_rows(rounds: int = 15, against: Path | None = None) -> Iterator[dict[str, Any]]:
    """Starts new processes in rounds: without a machine, with the C-arm, as in the README; of this tree and another.

    Args:
        rounds: how many, besides a first one that compiles what is not kept yet.
        against: folder that holds an earlier package, such as src of another checkout; None: there is none.

    Yields:
        Rows of case, rounds, median_ms, p99_ms, max_ms, and cpu_median_ms: processor time; before_ms and
        before_cpu_ms: the other tree's medians.

    Raises:
        InputError: a process failed; its message is the child's last line.
    """
    trees = [HERE] if against is None else [HERE, against.absolute()]
    found: dict[tuple[Path, str], list[Mapping[str, float]]] = {}
    for number in range(1 + rounds):
        for tree, what in itertools.product(trees, ("alone", "machine", "readme")):
            times = _started(what, tree)
            if number:
                found.setdefault((tree, what), []).append(times)
    for case, (what, key) in CASES.items():
        spent_ms, *before_ms = ([times[f"{key}_ms"] for times in found[tree, what]] for tree in trees)
        cpu_ms, *before_cpu_ms = ([times[f"{key}_cpu_ms"] for times in found[tree, what]] for tree in trees)
        yield {
            "case": case,
            "rounds": rounds,
            "median_ms": float(np.median(spent_ms)),
            "p99_ms": float(np.percentile(spent_ms, 99)),
            "max_ms": float(np.max(spent_ms)),
            "cpu_median_ms": float(np.median(cpu_ms)),
            "before_ms": float(np.median(before_ms[0])) if before_ms else None,
            "before_cpu_ms": float(np.median(before_cpu_ms[0])) if before_cpu_ms else None,
        }


def _started(what: str, tree: Path) -> dict[str, float]:
    """Times of one process, and its processor times [ms]."""
    done = subprocess.run(
        [sys.executable, "-P", str(SCRIPT), what],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(tree)},
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise InputError(f"bench: start of {tree} ended with {done.returncode}: {last}")
    times: dict[str, float] = json.loads(done.stdout)
    return times
