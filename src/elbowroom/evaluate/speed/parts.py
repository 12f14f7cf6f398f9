"""What the machine's parts of a pass take beside an earlier commit: image, body, motions, distances, a path."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import Due, where
from elbowroom.evaluate.speed.bench import save_scenes
from elbowroom.evaluate.speed.start import HERE
from elbowroom.geometry.parallel import default_threads

SCRIPT = Path(__file__).with_name("parts_case.py")
VOXEL_M = 0.02
DUE = (
    Due("median_ms", "≤", 5.0, where(case="explain", threads=2)),
    Due("median_ms", "≤", 4.0, where(case="eight motions", threads=2)),
    Due("median_ms", "≤", 5.0, where(case="path of 200 points", threads=2)),
)
"""On two cores."""


class Spent(NamedTuple):
    """Milliseconds of one look at a part: by the wall clock, and of processor time."""

    wall_ms: float
    cpu_ms: float


def parts_rows(
    rounds: int = 40, threads: int | None = None, against: Path | None = None
) -> Iterator[dict[str, Any]]:
    """Looks at each part in turns, in a process for each tree, which see the same images.

    Args:
        rounds: how often.
        threads: None: one a core.
        against: folder that holds an earlier package, such as src of another checkout; None: there is none.

    Yields:
        Rows of case, voxel_size_m, cameras, threads, rounds, median_ms, p99_ms, max_ms and cpu_median_ms: processor
        time; before_ms and before_cpu_ms: the other tree's medians.

    Raises:
        InputError: a process failed.
    """
    trees = [HERE] if against is None else [HERE, against.absolute()]
    threads = threads or default_threads()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        scene = Path(folder) / "scene.npz"
        save_scenes(scene, 21, "vga", True)
        found: list[dict[str, list[Spent]]] = [{} for _ in trees]
        looked = [stack.enter_context(_started(tree, scene, threads)) for tree in trees]
        for tree, process in zip(trees, looked, strict=True):
            _said(process, tree)
        for number in range(rounds):
            order = range(len(trees)) if number % 2 == 0 else reversed(range(len(trees)))
            for tree in order:
                for case, spent in _asked(looked[tree], trees[tree]).items():
                    found[tree].setdefault(case, []).append(Spent(*spent))
    said = {"voxel_size_m": VOXEL_M, "cameras": 21, "threads": threads, "rounds": rounds}
    for case in found[0]:
        yield {"case": case, **said, **_row([one[case] for one in found])}


def _started(tree: Path, scene: Path, threads: int) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-P", str(SCRIPT), str(scene), str(VOXEL_M), str(threads)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(tree)},
    )


def _said(process: "subprocess.Popen[str]", tree: Path) -> str:
    """Its next line.

    Raises:
        InputError: it ended.
    """
    assert process.stdout is not None
    line = process.stdout.readline()
    if not line:
        raise InputError(f"bench: parts of {tree} ended with {process.wait()}")
    return line


def _asked(process: "subprocess.Popen[str]", tree: Path) -> dict[str, Sequence[float]]:
    """One look at each part."""
    assert process.stdin is not None
    process.stdin.write("\n")
    process.stdin.flush()
    spent: dict[str, Sequence[float]] = json.loads(_said(process, tree))
    return spent


def _row(found: Sequence[Sequence[Spent]]) -> dict[str, float | None]:
    """Of one part, in this tree and perhaps another."""
    wall, cpu = ([one[n] for one in found[0]] for n in range(2))
    before = [float(np.median([one[n] for one in found[1]])) if len(found) > 1 else None for n in range(2)]
    return {
        "median_ms": float(np.median(wall)),
        "p99_ms": float(np.percentile(wall, 99)),
        "max_ms": float(np.max(wall)),
        "cpu_median_ms": float(np.median(cpu)),
        "before_ms": before[0],
        "before_cpu_ms": before[1],
    }
