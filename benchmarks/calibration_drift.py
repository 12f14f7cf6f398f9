"""The drift watch in the simulated room: knocks named, false alarms, wrong joints, its time.

    python benchmarks/calibration_drift.py [moments]

Writes benchmarks/results/calibration_drift.json. Some ten minutes on two cores with 1000 moments of 21 cameras.
"""

import sys
from pathlib import Path

from rich.console import Console

from elbowroom.cli.json_output import json_rows
from elbowroom.evaluate.bench_calibration_drift import drift_rows

RESULT = Path(__file__).resolve().parent / "results" / "calibration_drift.json"


def main() -> None:
    moments = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    console = Console(stderr=True)
    with json_rows(RESULT) as add, console.status("") as status:
        for row in drift_rows(status.update, moments=moments):
            add(row)
            console.print({k: v for k, v in row.items() if k not in ("cameras", "width", "height")})


if __name__ == "__main__":
    main()
