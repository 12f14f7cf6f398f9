"""How often the gate's latch is kept."""

from collections.abc import Sequence

from elbowroom.evaluate.latch.latch import DUE
from result_tables.cells import Cell, Row, of, table

COLUMNS: dict[str, Cell] = {
    "case": of("case"),
    "times": of("times"),
    "kept": of("kept"),
    "lost": of("lost", due=DUE),
    "causes not named": of("unnamed", due=DUE),
    "killed after it had latched": of("after_latching"),
    "killed inside a write": of("inside_a_write"),
    "unlatched, rightly": of("unlatched"),
}


def latch_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each way to lose it."""
    return table(rows, COLUMNS)
