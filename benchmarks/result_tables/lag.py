"""The closed loop beside exact geometry, exposure to decision, and what laws cost."""

from collections.abc import Sequence

from elbowroom.evaluate.lag import lag
from elbowroom.evaluate.speed import decision, laws
from result_tables.cells import Cell, Row, centimetres, of, table

LAG: dict[str, Cell] = {
    "cameras": lambda row: f"{row['cameras']} x {row['width']}x{row['height']}",
    "voxel": centimetres,
    "skew, ms": of("skew_ms", 0),
    "of": of("which"),
    "minutes": of("minutes", 0),
    "windows": of("windows"),
    "should have stopped and did not": of("missed", due=lag.DUE),
    "stopped before": of("stopped_before"),
    "late, within the reaction time": of("late"),
    "lag of these, median ms": of("lag_median_ms", 0),
    "worst ms": of("lag_worst_ms", 0),
    "over before anybody could react": of("never_stopped"),
    "stopped for nothing": of("needless"),
    "of the time %": of("needless_pct", 1),
    "people touched": of("touched", due=lag.DUE),
    "nearest, mm": of("least_gap_mm", 0),
}
DECISION: dict[str, Cell] = {
    "cameras": lambda row: (
        f"{row['cameras']} x {row['width']}x{row['height']}, {row['rate_hz']:g} Hz, {row['case']}"
    ),
    "voxel": centimetres,
    "threads": of("threads"),
    "passes": of("passes"),
    "past their age": of("late"),
    "median ms": of("median_ms", 1),
    "99 % ms": of("p99_ms", 1, due=decision.DUE),
    "worst ms": of("max_ms", 1),
    "where the worst went, ms": decision.words_of_worst,
}


LAWS: dict[str, Cell] = {
    "pass with": of("case"),
    "voxel": centimetres,
    "detail": of("detail"),
    "rounds": of("rounds"),
    "median ms": of("median_ms", 1),
    "99 % ms": of("p99_ms", 1),
    "of that with neither": of("share", 2, due=laws.DUE),
}


def lag_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each skew, of all motions and of the machine's own."""
    return table([row for row in rows if row.get("kind") == "lag"], LAG)


def decision_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each case."""
    return table(rows, DECISION)


def law_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each case."""
    return table(rows, LAWS)
