"""Rows as tables."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from elbowroom.evaluate.due import Row
from elbowroom.view.report.blocks import Table

Cell = str | Callable[[Row], str]
"""What stands in a column: a format of the row's values, such as "{cameras}", or a function of the row."""


def table_of(title: str, rows: Iterable[Row], columns: Mapping[str, Cell], left: Sequence[str]) -> Table:
    """A line for each row.

    Args:
        title: above it.
        rows: values by key.
        columns: their cells, by heading.
        left: headings of columns that are words and stand to the left.
    """
    lines = [[_text(cell, row) for cell in columns.values()] for row in rows]
    return Table(title, tuple(columns), lines, [n for n, name in enumerate(columns) if name in left])


def _text(cell: Cell, row: Row) -> str:
    return cell.format(**row) if isinstance(cell, str) else cell(row)
