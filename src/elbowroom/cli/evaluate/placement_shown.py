"""The figures of placement on the screen."""

from collections.abc import Sequence
from typing import Any

from elbowroom.cli.evaluate.shown import print_
from elbowroom.evaluate.due import Due, Row, due_of
from elbowroom.evaluate.placement.rows import DUE
from elbowroom.view.report.blocks import Table
from elbowroom.view.report.tables import rich_table

FIGURES = {
    "verify": ("{cameras} cameras, {points:,} points", (("seconds", "median_s", "{:.2f}"),)),
    "sweep": ("{layouts} layouts", (("seconds", "seconds", "{:.1f}"),)),
    "optimise": (
        "optimised for {what}",
        (
            ("cameras", "cameras", "{}"),
            ("valid [%]", "valid_pct", "{:.2f}"),
            ("19 or fewer after [s]", "seconds_to_19", "{:.0f}"),
        ),
    ),
    "prediction": (
        "free space, {room}, {size}",
        (
            ("predicted [%]", "predicted_free_pct", "{:.2f}"),
            ("found [%]", "found_free_pct", "{:.2f}"),
            ("apart at most [points]", "difference_pct", "{:.2f}"),
        ),
    ),
}
"""What is shown of each kind of row: what it is of, then words, key and how the value is written."""


def show(rows: Sequence[Row]) -> None:
    """A line for each figure, with what is due of it."""
    lines = []
    for row in rows:
        what, figures = FIGURES[row["kind"]]
        for words, key, how in figures:
            value: Any = abs(row[key]) if key == "difference_pct" else row[key]
            due = due_of(DUE[row["kind"]], key, row)
            text = "-" if value is None else how.format(value)
            lines.append((what.format(**row), words, text, "" if due is None else _said(due, row)))
    print_(rich_table(Table("", ("what", "figure", "measured", "due"), lines, left=(0, 1, 3))))


def _said(due: Due, row: Row) -> str:
    return f"{due.for_row(row):g} at {'least' if due.sign == '≥' else 'most'}"
