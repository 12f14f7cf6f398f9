"""How many pixels real depth cameras lose on smooth surfaces, by how obliquely they see them.

    python benchmarks/lost_pixels.py

Writes benchmarks/results/lost_pixels.json, from the recordings sevenscenes and piv_table_2cam under $ELBOWROOM_DATA
(../shared/data by default). The simulator's shares of lost pixels are set by it. A pixel counts where inverse depth
runs straight through those two and three pixels to both sides of it, along its row or its column: a plane, since
inverse depth is linear over the image of one. Holes of more than three pixels, as behind edges, are not counted.
"""

import json
import os
from pathlib import Path

import numpy as np
from PIL import Image

from elbowroom.files.atomic import whole_file
from elbowroom.files.json_rows import meta

RESULT = Path(__file__).resolve().parent / "results" / "lost_pixels.json"
DATA = Path(os.environ.get("ELBOWROOM_DATA", "../shared/data"))
RECORDINGS = {"sevenscenes": 585.0, "piv_table_2cam": 570.0}
"""Focal length of each recording's cameras [px]."""
TANGENTS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)
"""Least tangents of the angle of incidence, of each row."""
STRAIGHT_PER_M = 0.004
"""By how much inverse depth may bend over the support [1/m]."""
NEAREST_M, FARTHEST_M = 0.5, 4.0


def counts_of(depth_m: np.ndarray, focal: float) -> tuple[np.ndarray, np.ndarray]:
    """Tangent of the angle of incidence, and whether the pixel is lost, of all that count along rows."""
    inverse = 1 / depth_m
    columns = depth_m.shape[1] - 6
    before, left, here, right, after = (inverse[:, at : at + columns] for at in (0, 1, 3, 5, 6))
    slope, middle = (right - left) / 4, (left + right) / 2
    straight = np.abs(left - slope - before) < STRAIGHT_PER_M
    straight &= np.abs(right + slope - after) < STRAIGHT_PER_M
    straight &= (middle > 1 / FARTHEST_M) & (middle < 1 / NEAREST_M)
    return (np.abs(slope) * focal / middle)[straight], np.isnan(here)[straight]


def rows_of(recording: str, focal: float) -> list[dict[str, object]]:
    """A row for each range of tangents."""
    pixels, lost = np.zeros(len(TANGENTS), dtype=int), np.zeros(len(TANGENTS), dtype=int)
    files = sorted((DATA / recording).glob("*depth.png"))
    if not files:
        raise SystemExit(
            f"{DATA / recording}: no depth images; set ELBOWROOM_DATA to the folder of recordings"
        )
    for file in files:
        depth = np.array(Image.open(file)).astype(float) / 1000
        depth[(depth == 0) | (depth > 60)] = np.nan
        for turned in (depth, depth.T):
            tangents, gone = counts_of(turned, focal)
            at = np.searchsorted(TANGENTS, tangents, side="right") - 1
            pixels += np.bincount(at, minlength=len(TANGENTS))
            lost += np.bincount(at[gone], minlength=len(TANGENTS))
    ends = (*TANGENTS[1:], None)
    return [
        {
            "recording": recording,
            "tangent_from": start,
            "tangent_to": end,
            "pixels": int(count),
            "lost_pct": 100 * float(gone) / count if count else None,
        }
        for start, end, count, gone in zip(TANGENTS, ends, pixels, lost, strict=True)
    ]


def main() -> None:
    rows = [row for recording, focal in RECORDINGS.items() for row in rows_of(recording, focal)]
    said = meta() | {"command": "python benchmarks/lost_pixels.py"}
    with whole_file(RESULT) as unfinished:
        unfinished.write_text(json.dumps({"meta": said, "rows": rows}, indent=1) + "\n", encoding="utf-8")
    for row in rows:
        print(row)


if __name__ == "__main__":
    main()
