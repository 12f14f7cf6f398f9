"""Tables of a report on the screen."""

from rich.table import Table as RichTable

from elbowroom.view.report.blocks import Table


def rich_table(table: Table) -> RichTable:
    """The table as rich prints it."""
    shown = RichTable(title=table.title, title_justify="left", box=None, pad_edge=False)
    for index, column in enumerate(table.columns):
        shown.add_column(column, justify="left" if index in table.left else "right")
    for line in table.lines:
        shown.add_row(*line)
    return shown
