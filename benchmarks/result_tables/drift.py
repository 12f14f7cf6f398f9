"""The drift watch: knocks, wrong joints, pushed furniture, false alarms, real cameras, time."""

from collections.abc import Mapping, Sequence

from elbowroom.evaluate.drift.due import DUE
from result_tables.cells import Cell, Row, of, table

NOISE: dict[str, Cell] = {"noise": of("noise")}


def _with_unit(key: str) -> Cell:
    return lambda row: f"{row[key]:.2f} {row['unit']}" if row.get(key) is not None else ""


def _too_much(row: Row) -> str:
    return (
        f"{row['wrong_by'] * 1e3:.0f} mm" if row["joint"] == "long" else f"{row['wrong_by'] * 57.29578:.0f}°"
    )


def _said(row: Row) -> str:
    return "" if row.get("said") is None else f"{row['said']:.2f} ± {row['two_sigma']:.2f} {row['unit']}"


COLUMNS: Mapping[str, Mapping[str, Cell]] = {
    "knock": {
        "knock": of("knock"),
        **NOISE,
        "runs": of("runs"),
        "named": of("named", due=DUE["knock"]),
        "others": of("others_named", due=DUE["knock"]),
        "frames, median": of("frames_median", 0),
        "frames, most": of("frames_max", due=DUE["knock"]),
        "said, median": _with_unit("said_median"),
        "error, 95 %": _with_unit("error_p95"),
        "within 2 σ %": of("inside_2_sigma_pct", 0),
        "named by a part of it": of("named_by_a_part"),
    },
    "not shown": {
        "camera": of("camera"),
        **NOISE,
        "not shown": of("not_shown"),
        "turn, degrees": of("turn_deg", 3),
        "move, mm": of("move_mm", 0),
        "exact images differ by, mm, 99 %": of("differs_mm", 2),
        "root of the mean square, σ of the sensor": of("differs_sigmas", 2),
    },
    "wrong joint": {
        "joint": of("joint"),
        "says too much by": _too_much,
        **NOISE,
        "found": of("found"),
        "frames": of("frames"),
        "cameras named": of("cameras_named", due=DUE["wrong joint"]),
        "said": of("reason"),
    },
    "furniture": {"pushed": of("what"), **NOISE, "cameras named": of("cameras_named", due=DUE["furniture"])},
    "false alarms": {
        **NOISE,
        "passes": of("passes"),
        "camera frames": of("camera_frames", due=DUE["false alarms"]),
        "false alarms": of("false_alarms", due=DUE["false alarms"]),
        "frames in doubt": of("frames_in_doubt", due=DUE["false alarms"]),
        "frames that said moved %": of("frames_that_said_moved_pct", 3),
        "frames that could not tell %": of("frames_that_could_not_tell_pct", 2),
    },
    "doubt": {
        "knock": of("knock"),
        **NOISE,
        "cameras": of("runs"),
        "in doubt at the first image": of("in_doubt_at_once", due=DUE["doubt"]),
        "images without a doubt, after it": of("undoubted_frames", due=DUE["doubt"]),
        "named": of("named", due=DUE["doubt"]),
    },
    "recorded": {
        "recording": of("site"),
        "knock of one camera": of("knock"),
        "named": of("named"),
        "others": of("others_named", due=DUE["recorded"]),
        "passes": of("passes"),
        "said": _said,
    },
    "watch time": {
        "a pass": lambda row: f"{row['cameras']} cameras {row['width']}x{row['height']}, with body",
        "median ms": of("median_ms", 1, due=DUE["watch time"]),
        "99 % ms": of("p99_ms", 1),
        "worst ms": of("max_ms", 1),
        "processor time, median ms": of("cpu_median_ms", 1),
    },
}


def drift_tables(rows: Sequence[Row]) -> list[str]:
    """A table for each kind of row."""
    lines: list[str] = []
    for kind, columns in COLUMNS.items():
        mine = [row for row in rows if row["kind"] == kind]
        if mine:
            lines += ["", *table(mine, columns)]
    return lines
