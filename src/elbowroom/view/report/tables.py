"""Tables of a report on the screen."""

from rich.markup import escape
from rich.table import Table as RichTable

from elbowroom.view.report.blocks import Table


def rich_table(table: Table) -> RichTable:
    """The table as rich prints it; what stands in brackets is a unit, not a style."""
    shown = RichTable(title=escape(table.title), title_justify="left", box=None, pad_edge=False)
    for index, column in enumerate(table.columns):
        shown.add_column(escape(column), justify="left" if index in table.left else "right")
    for line in table.lines:
        shown.add_row(*map(escape, line))
    return shown
