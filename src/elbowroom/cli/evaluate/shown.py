"""Rows on the screen, with what is due."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from elbowroom.evaluate.due import Due, Row, due_of
from elbowroom.evaluate.tables import Cell, table_of
from elbowroom.view.report.blocks import Table
from elbowroom.view.report.tables import rich_table

Show = Callable[[Sequence[Mapping[str, Any]]], None]
LEFT = ("case", "detail", "noise", "margin", "rule", "figure", "due", "solid", "recording", "search")
"""Columns of words."""
WIDE = 140
"""Columns of text where no terminal says how many it has."""


def as_table(columns: Mapping[str, Cell], *notes: str) -> Show:
    """Shows a line for each row, then notes, such as what is due.

    Args:
        columns: cells by heading, as `table_of` takes them.
        notes: below it.
    """

    def show(rows: Sequence[Row]) -> None:
        print_(rich_table(table_of("", rows, columns, LEFT)))
        for note in notes:
            print_(note)

    return show


def as_figures(dues: Sequence[Due], *figures: tuple[str, str, str]) -> Show:
    """Shows a line for each figure of one summary, with what is due of it.

    Args:
        dues: of the experiment.
        figures: words, key, and how the value is written.
    """

    def show(rows: Sequence[Row]) -> None:
        (summary,) = rows
        lines = []
        for words, key, how in figures:
            due = due_of(dues, key, summary)
            value = "-" if summary[key] is None else how.format(summary[key])
            lines.append((words, value, due.said if due else ""))
        print_(rich_table(Table("", ("figure", "measured", "due"), lines, left=(0, 2))))

    return show


def print_(what: RichTable | str) -> None:
    """Prints it; tables are not folded where nobody says how wide the screen is."""
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = max(console.width, WIDE)
    console.print(Text(what) if isinstance(what, str) else what)


def voxel(row: Row) -> str:
    """The edge of a voxel."""
    return f"{row['voxel_size_m'] * 100:g} cm"


def yes_or_no(key: str) -> Callable[[Row], str]:
    """A cell for what is true or not."""
    return lambda row: "yes" if row[key] else "no"


def text(form: str, *keys: str) -> Callable[[Row], str]:
    """A cell for values that a row may lack.

    Args:
        form: how a value is written.
        keys: of the values.
    """
    return lambda row: " / ".join("-" if row.get(key) is None else form.format(row[key]) for key in keys)
