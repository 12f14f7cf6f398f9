"""The drift watch in the simulated room: knocks named, wrong joints, pushed furniture, false alarms, its time.

    python benchmarks/calibration_drift.py [part ...]

Writes benchmarks/results/calibration_drift.json. Parts are knocks, joints, furniture, alarms, real and time; rows of
parts that are not named stay as they are in the file. `real` plays examples/piv_table_2cam.yaml. All of them take some
fifteen minutes on two cores.
"""

import json
import sys
from pathlib import Path

from rich.console import Console

from elbowroom.cli.json_output import meta
from elbowroom.evaluate.bench_calibration_drift import PARTS, drift_rows
from elbowroom.site import Site
from elbowroom.view.atomic import whole_file

RECORDED = Path(__file__).resolve().parents[1] / "examples" / "piv_table_2cam.yaml"
RESULT = Path(__file__).resolve().parent / "results" / "calibration_drift.json"


def main() -> None:
    parts = sys.argv[1:] or PARTS
    unknown = [part for part in parts if part not in PARTS]
    if unknown:
        raise SystemExit(f"no part {unknown[0]}; parts are {', '.join(PARTS)}")
    console, rows = Console(stderr=True), []
    with console.status("") as status:
        tell = status.update if console.is_terminal else console.print
        for row in drift_rows(tell, parts, recorded=Site.load(RECORDED) if "real" in parts else None):
            rows.append({**row, "commit": meta()["commit"]})
            console.print({k: v for k, v in row.items() if k not in ("cameras", "width", "height")})
    # read again: another part may have been written meanwhile
    kept = json.loads(RESULT.read_text())["rows"] if RESULT.exists() else []
    together = rows + [row for row in kept if row["part"] not in parts]
    content = {
        "meta": {**meta(), "command": "python benchmarks/calibration_drift.py"},
        "rows": sorted(together, key=lambda row: PARTS.index(row["part"])),
    }
    with whole_file(RESULT) as unfinished:
        unfinished.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
