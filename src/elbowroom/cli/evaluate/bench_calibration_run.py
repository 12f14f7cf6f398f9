"""The run of `elbowroom bench calibration`."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from elbowroom.cli.evaluate.measured import Tell, telling
from elbowroom.errors import InputError
from elbowroom.evaluate.calibrating.extrinsics import CASES, PARTS, extrinsics_rows
from elbowroom.evaluate.calibrating.intrinsics import intrinsics_row
from elbowroom.evaluate.calibrating.machine import machine_row, refine_rows, room_refine_row
from elbowroom.evaluate.drift import drift_rows
from elbowroom.evaluate.examples import EXAMPLES
from elbowroom.files.atomic import folder
from elbowroom.files.json_rows import json_rows

MORE = ("intrinsics", "machine", "refine", "drift")
SHOWN = (
    "case",
    "worst_mm",
    "worst_deg",
    "median_mm",
    "median_deg",
    "inside_pct",
    "worst_focal_pct",
    "seconds",
    "occupied_pct",
    "found_pct",
    "agree_pct",
    "knock",
    "joint",
    "what",
    "noise",
    "runs",
    "named",
    "others_named",
    "in_doubt_at_once",
    "frames_in_doubt",
    "found",
    "frames_max",
    "cameras_named",
    "camera_frames",
    "false_alarms",
    "not_shown",
    "differs_mm",
    "median_ms",
    "note",
)


def run_bench_calibration(
    quick: bool,
    captures: Path | None,
    parts: Sequence[str],
    json_file: Path | None,
    examples: Path | None = None,
) -> None:
    """Measures board, machine, refinement and drift watch, and prints a line for each row.

    Args:
        quick: one capture of five cameras and twelve poses, ten draws, and nothing else.
        captures: folder where simulated captures are kept; None: a temporary one.
        parts: which to measure, of `PARTS`; none: all.
        json_file: for the rows.
        examples: folder of the examples' site files; None: that of a checkout.

    Raises:
        InputError: a part that is none.
    """
    unknown = [part for part in parts if part not in (*PARTS, *MORE)]
    if unknown:
        raise InputError(f"--part: {unknown[0]!r} is unknown; parts are {', '.join((*PARTS, *MORE))}")
    with tempfile.TemporaryDirectory() as temporary, json_rows(json_file) as add, telling() as tell:
        kept = Path(temporary) if captures is None else folder(captures)
        for row in _rows(quick, kept, parts, examples or EXAMPLES, tell):
            add(row)
            _say(row)


def _rows(
    quick: bool, captures: Path, parts: Sequence[str], examples: Path, tell: Tell
) -> Iterator[dict[str, Any]]:
    quickly: dict[str, Any] = {"cases": CASES[:1], "cameras": 5, "poses": 12, "draws": 10} if quick else {}
    yield from extrinsics_rows(tell, captures, parts or PARTS, **quickly, examples=examples)
    for part in () if quick else [part for part in MORE if part in (parts or MORE)]:
        if part == "intrinsics":
            yield intrinsics_row(captures, said=tell)
        elif part == "machine":
            yield machine_row(said=tell)
        elif part == "refine":
            yield room_refine_row(said=tell)
            yield from refine_rows(examples, said=tell)
        else:
            yield from drift_rows(tell, examples=examples)


def _say(row: Mapping[str, Any]) -> None:
    """The row in a line."""
    words = [f"{key} {_short(row[key])}" for key in SHOWN if row.get(key) is not None]
    print(f"{row['kind']:11} {', '.join(words)}", flush=True)


def _short(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_short(item)}" for key, item in value.items())
    return f"{value:.4g}" if isinstance(value, float) else str(value)
