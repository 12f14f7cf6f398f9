"""The run of `elbowroom bench calibration`."""

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.errors import InputError
from elbowroom.evaluate.calibrating.extrinsics import CASES, PARTS, extrinsics_rows
from elbowroom.evaluate.calibrating.intrinsics import intrinsics_row
from elbowroom.evaluate.calibrating.machine import machine_row, refine_rows, room_refine_row
from elbowroom.evaluate.drift import drift_rows
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
    quick: bool, captures: Path | None, parts: Sequence[str], json_file: Path | None
) -> None:
    """Measures board, machine, refinement and drift watch, and prints a line for each row.

    Args:
        quick: one capture of five cameras and twelve poses, ten draws, and nothing else.
        parts: which to measure, of `PARTS`; none: all.
        captures: folder where simulated captures are kept; None: a temporary one.
        json_file: for the rows.

    Raises:
        InputError: a part that is none.
    """
    unknown = [part for part in parts if part not in (*PARTS, *MORE)]
    if unknown:
        raise InputError(f"--part: {unknown[0]!r} is unknown; parts are {', '.join((*PARTS, *MORE))}")
    console = Console(stderr=True)
    with (
        tempfile.TemporaryDirectory() as temporary,
        json_rows(json_file) as add,
        console.status("") as status,
    ):
        kept = Path(temporary) if captures is None else folder(captures)

        def tell(text: str) -> None:
            status.update(text)
            if not console.is_terminal:
                console.print(text, highlight=False)

        quickly: dict[str, Any] = (
            {"cases": CASES[:1], "cameras": 5, "poses": 12, "draws": 10} if quick else {}
        )
        for row in extrinsics_rows(tell, kept, parts or PARTS, **quickly):
            add(row)
            _say(row)
        for part in () if quick else [part for part in MORE if part in (parts or MORE)]:
            for row in _more_rows(part, kept, tell):
                add(row)
                _say(row)


def _more_rows(part: str, captures: Path, tell: Callable[[str], None]) -> Iterator[dict[str, Any]]:
    """The rows of a part of `MORE`."""
    if part == "intrinsics":
        yield intrinsics_row(captures, said=tell)
    elif part == "machine":
        yield machine_row(said=tell)
    elif part == "refine":
        yield room_refine_row(said=tell)
        yield from refine_rows(said=tell)
    else:
        yield from drift_rows(tell)


def _say(row: Mapping[str, Any]) -> None:
    """The row in a line."""
    words = [f"{key} {_short(row[key])}" for key in SHOWN if row.get(key) is not None]
    print(f"{row['kind']:11} {', '.join(words)}", flush=True)


def _short(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_short(item)}" for key, item in value.items())
    return f"{value:.4g}" if isinstance(value, float) else str(value)
