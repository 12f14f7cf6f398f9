"""The figures that the project set out to reach beside those found and the thesis' own; what misses is said to miss."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from elbowroom.evaluate.due import Due, Row
from elbowroom.evaluate.thesis.part import Part
from elbowroom.view.report.blocks import Table, pct

TITLE = "What was due"


def worst(rows: Sequence[Row], due: Due) -> Row:
    """The row whose value is the farthest from what is due."""
    return (min if due.sign == "≥" else max)(rows, key=lambda row: row[due.key])


def first(rows: Sequence[Row], due: Due) -> Row:
    """The row that comes first, of variants of which the first is the one that figures are due of."""
    return rows[0]


def of_nothing(row: Row) -> str:
    """No words beside a figure."""
    return ""


@dataclass(frozen=True, slots=True)
class DueLine(Due):
    """A figure that has a line in the table of what was due.

    Args:
        name: of the line; values of the row stand in it in braces.
        thesis: what the thesis has.
        digits: after the point, of a figure that is due at least.
        pick: of the rows of which it is due, the one that is shown.
        beside: what is said of that row besides.
    """

    name: str = ""
    thesis: str = ""
    digits: int = 2
    pick: Callable[[Sequence[Row], Due], Row] = worst
    beside: Callable[[Row], str] = of_nothing

    def cells(self, rows: Sequence[Row]) -> tuple[str, ...] | None:
        """The line's cells; None if nothing in the rows answers it."""
        asked = [row for row in rows if self.of(row)]
        if not asked:
            return None
        row = self.pick(asked, self)
        verdict = "reached" if self.met(row) else "missed"
        beside = self.beside(row)
        return (
            self.name.format(**row),
            self.thesis,
            f"{self.for_row(row):g}",
            self._found(row[self.key]),
            f"{verdict}; {beside}" if beside else verdict,
        )

    def _found(self, value: Any) -> str:
        """Shares are rounded down, so that no share reads as more than it is."""
        if self.sign == "≥":
            return pct(value, self.digits)
        return "-" if value is None else f"{value:.1f}" if isinstance(value, float) else str(value)


def due_table(parts: Sequence[Part], rows: Sequence[Row]) -> Table | None:
    """A line for each figure that the rows answer; None if they answer none.

    Args:
        parts: whose figures are asked for.
        rows: of all parts, each with its `part`, summaries among them.
    """
    lines = []
    for part in parts:
        mine = [row for row in rows if row.get("part") == part.name]
        found = [due.cells(mine) for due in part.due if isinstance(due, DueLine)]
        lines += [cells for cells in found if cells is not None]
    columns = ("figure", "thesis", "due", "found", "")
    return Table(TITLE, columns, lines, left=(0, 4)) if lines else None
