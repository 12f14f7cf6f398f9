"""What a command shows beside plain lines: tables, and what stands below them."""

from rich.console import Console
from rich.text import Text

from elbowroom.view.report.blocks import Table
from elbowroom.view.report.tables import rich_table

WIDE = 140
"""Columns of text where no terminal says how many it has."""


def show(table: Table) -> None:
    """Prints a table; it is not folded where nobody says how wide the screen is."""
    console().print(rich_table(table))


def note(words: str) -> None:
    """Prints what explains a table, paler than the table on a terminal."""
    console().print(Text(words, style="dim"))


def console() -> Console:
    """Where tables are printed; as wide as they are where no terminal says how wide it is."""
    made = Console(highlight=False)
    if not made.is_terminal:
        made.width = max(made.width, WIDE)
    return made
