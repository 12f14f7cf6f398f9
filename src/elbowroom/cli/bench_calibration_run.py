"""The run of `elbowroom bench calibration`."""

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.json_output import json_rows
from elbowroom.evaluate.bench_calibration import extrinsics_rows
from elbowroom.evaluate.bench_calibration_boards import intrinsics_row
from elbowroom.evaluate.bench_calibration_machine import machine_row, refine_rows
from elbowroom.view.atomic import folder

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
    "note",
)


def run_bench_calibration(quick: bool, captures: Path | None, json_file: Path | None) -> None:
    """Measures board, machine and refinement, and prints a line for each row.

    Args:
        quick: five cameras, twelve poses and ten draws, and neither machine nor refinement.
        captures: folder where simulated captures are kept; None: a temporary one.
        json_file: for the rows.
    """
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

        size = {"cameras": 5, "poses": 12, "draws": 10} if quick else {}
        for row in extrinsics_rows(tell, kept, **size):
            add(row)
            _say(row)
        if quick:
            return
        row = intrinsics_row(kept, said=tell)
        add(row)
        _say(row)
        row = machine_row(said=tell)
        add(row)
        _say(row)
        for row in refine_rows(said=tell):
            add(row)
            _say(row)


def _say(row: Mapping[str, Any]) -> None:
    """The row in a line."""
    words = [f"{key} {_short(row[key])}" for key in SHOWN if row.get(key) is not None]
    print(f"{row['kind']:11} {', '.join(words)}", flush=True)


def _short(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key}: {_short(item)}" for key, item in value.items())
    return f"{value:.4g}" if isinstance(value, float) else str(value)
