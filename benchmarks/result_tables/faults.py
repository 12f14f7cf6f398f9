"""Faults thrown at a running monitor."""

from collections.abc import Sequence

from elbowroom.evaluate.faults.faults import DUE
from result_tables.cells import Cell, Row, of, table

COLUMNS: dict[str, Cell] = {
    "input": of("input"),
    "fault": of("case"),
    "times": of("times"),
    "shown": of("shown"),
    "silent": of("silent", due=DUE),
    "misnamed": of("misnamed", due=DUE),
    "median [ms]": of("median_ms", 0),
    "worst [ms]": of("worst_ms", 0, due=DUE),
    "noticed by": of("noticed_by"),
    "named": of("causes"),
}


def fault_tables(rows: Sequence[Row]) -> list[str]:
    """A row for each kind of fault, and one for all."""
    return table([row for row in rows if "times" in row], COLUMNS)
