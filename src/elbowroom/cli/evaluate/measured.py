"""What every command that measures does with its rows: to the file as they come, progress beside them, then shown."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from elbowroom.cli.evaluate.shown import Show, print_
from elbowroom.errors import ElbowroomError
from elbowroom.files.json_rows import json_rows

Row = Mapping[str, Any]
Tell = Callable[[str], None]
Item = TypeVar("Item")


def measured(
    what: str,
    found: Iterable[Row],
    total: int | None,
    json: Path | None,
    show: Show,
    summary: Callable[[Sequence[Row]], Sequence[Row]] | None = None,
) -> None:
    """Writes rows and their summary, then shows the summary, or else the rows.

    Where there is a summary, rows leave out what it says. After Ctrl-C or an error: shows what there is; its rows are
    kept aside.

    Args:
        what: the rows are.
        found: rows as they are measured.
        total: how many there will be; None: that is not known, or told otherwise.
        json: file for the rows.
        show: prints them.
        summary: rows that sum them up.
    """
    from elbowroom.evaluate.rooms.scene import lean

    rows: list[Row] = []
    try:
        with json_rows(json) as add:
            for row in found if total is None else watched(what, found, total):
                add(lean(row) if summary else row)
                rows.append(row)
            shown = summary(rows) if summary else rows
            for row in shown if summary else ():
                add(row)
    except (KeyboardInterrupt, ElbowroomError, OSError) as ended:
        if rows:
            show(summary(rows) if summary else rows)
            of = "" if total is None else f" of {total}"
            how = "Interrupted" if isinstance(ended, KeyboardInterrupt) else "Ended by an error"
            print_(f"{how} after {len(rows)}{of} {what}.")
        raise
    show(shown)


def watched(what: str, rows: Iterable[Item], total: int) -> Iterable[Item]:
    """The rows, with a bar on a terminal.

    Args:
        what: they are.
        rows: as they come.
        total: how many there will be.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        yield from progress.track(rows, total=total, description=what)


@contextmanager
def telling() -> Iterator[Tell]:
    """Gives a function that tells what is being done: in one line on a terminal, in lines elsewhere."""
    console = Console(stderr=True)
    with console.status("") as status:

        def tell(text: str) -> None:
            status.update(text)
            if not console.is_terminal:
                console.print(text, highlight=False)

        yield tell


def told(rows: Callable[[Tell], Iterable[Row]]) -> Iterator[Row]:
    """Rows of a function that tells what is being done."""
    with telling() as tell:
        yield from rows(tell)
