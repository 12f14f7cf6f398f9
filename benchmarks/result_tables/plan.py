"""From a drag to the figures of a plan."""

from collections.abc import Sequence

from elbowroom.evaluate.plan.measured import DUE
from result_tables.cells import Cell, Row, of, table

CELLS: dict[str, Cell] = {
    "room": of("room"),
    "moved": of("deed"),
    "cameras": of("cameras"),
    "times": of("times"),
    "first figures, median ms": of("coarse_ms", 0, due=DUE),
    "worst": of("coarse_worst_ms", 0),
    "exact, median ms": of("exact_ms", 0, due=DUE),
    "worst ": of("exact_worst_ms", 0),
}


def plan_table(rows: Sequence[Row]) -> list[str]:
    """A row for each room and deed."""
    return table(rows, CELLS)
