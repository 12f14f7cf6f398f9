"""Cameras that were found, beside their truth."""

from collections.abc import Sequence

from elbowroom.evaluate.due import Due
from result_tables.cells import Row, of, table


def calibration_tables(rows: Sequence[Row]) -> list[str]:
    """Captures, the room, coverage, real recordings, each with its own columns."""
    lines: list[str] = []
    for kind, keys in CALIBRATION_COLUMNS.items():
        mine = [row for row in rows if row["kind"] == kind]
        if mine:
            lines += ["", *table(mine, {key: of(key, due=_due_of(key)) for key in keys})]
    return lines


ACCURACY = ("worst_mm", "worst_deg", "median_mm", "median_deg")
CALIBRATION_COLUMNS = {
    "extrinsics": (
        "case",
        "world",
        "noise",
        "cameras",
        "poses",
        "views",
        *ACCURACY,
        "inside_pct",
        "seconds",
    ),
    "room": (
        "case",
        "noise",
        "occupied_pct",
        "found_pct",
        "sensor_lateral_px",
        "pose_lateral_px",
        "pose_bias_mm",
        "margin_held_pct",
    ),
    "coverage": (
        "case",
        "world",
        "cameras",
        "poses",
        "draws",
        "inside_pct",
        "margin_held_pct",
        "mean_square",
    ),
    "images": (
        "case",
        "noise",
        "poses",
        "views",
        "bias_px",
        "bias_sigma_px",
        "common_px",
        "within_px",
        "said_px",
        "inside_pct",
        "mean_square",
    ),
    "real": ("case", "agree_pct", "shares_pct", "note"),
    "machine": (
        "cameras",
        "poses",
        *ACCURACY,
        "inside_pct",
        "seconds",
    ),
    "refine": (
        "start",
        "agree_pct",
        "worst_mm",
        "worst_deg",
        "median_mm",
        "median_deg",
        "seconds",
        "note",
    ),
    "intrinsics": ("case", "views", "worst_focal_pct", "focal_error_pct", "seconds"),
}


def _due_of(key: str) -> tuple[Due, ...]:
    """The row's own due figure; at least for shares, at most for errors and times."""

    def is_due(row: Row) -> bool:
        wanted = row.get("due", {}).get(key)
        return isinstance(wanted, int | float) and isinstance(row.get(key), int | float)

    is_error = key.startswith("worst") or not key.endswith("_pct")
    return (Due(key, "≤" if is_error else "≥", lambda row: float(row["due"][key]), is_due),)
