"""All cases of `elbowroom bench --all`, one after the other, each in a process of its own."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from elbowroom.errors import InputError
from elbowroom.evaluate.speed.asked_scene import save_scene, scene_of
from elbowroom.evaluate.speed.others import other_rows
from elbowroom.evaluate.speed.questions import Asked


def asked_rows(cases: Sequence[Asked], others: bool = True) -> Iterator[dict[str, Any]]:
    """Measures one case after the other.

    Args:
        cases: what to measure; those that see the same, one after the other, are rendered once.
        others: also other systems on the same images, where they are installed.

    Yields:
        Rows of what was asked (`questions.Asked`), median_ms, p99_ms, max_ms, cause (of the slowest), stages_ms
        (medians), peak_rss_mb; of the carve of a hall voxels and surface_voxels.

    Raises:
        InputError: a case failed; its message is the child's last line.
    """
    with tempfile.TemporaryDirectory() as folder:
        seen: dict[tuple[Any, ...], Path] = {}
        for case in cases:
            key = scene_of(case)
            if key not in seen:
                seen[key] = Path(folder) / f"scene{len(seen)}.npz"
                save_scene(seen[key], case)
            yield _in_own_process(seen[key], case)
            if not case.rounds or key[0] != "people walking" or key[2] != 21:
                seen.pop(key).unlink()  # images of one case alone would fill the disk
    if others:
        yield from other_rows()


def _in_own_process(scene_file: Path, case: Asked) -> dict[str, Any]:
    given = {"scene_file": str(scene_file), **asdict(case)}
    module = "elbowroom.evaluate.speed.asked_case"
    done = subprocess.run([sys.executable, "-m", module, json.dumps(given)], capture_output=True, text=True)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise InputError(f"bench: case {case} ended with {done.returncode}: {last}")
    row: dict[str, Any] = json.loads(done.stdout)
    return row
