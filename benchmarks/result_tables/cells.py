"""Cells and tables in Markdown, the figure that is due beside the measured one."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from elbowroom.evaluate.due import Due, Row, due_of

Cell = Callable[[Row], str]


def table(rows: Iterable[Row], columns: Mapping[str, Cell]) -> list[str]:
    """Rows as a Markdown table."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(cell(row) for cell in columns.values()) + " |" for row in rows]
    return lines


def plain(value: Any) -> str:
    """A value as a cell: yes or no, a few digits, or nothing."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {plain(item)}" for key, item in value.items())
    return str(value)


def of(key: str, digits: int | None = None, *, due: Sequence[Due] = ()) -> Cell:
    """A cell with one value of the row.

    Args:
        key: of the value.
        digits: after the point; None: as it comes.
        due: figures of the experiment; the first of this value that is due of the row stands beside it.
    """

    def cell(row: Row) -> str:
        value = row.get(key)
        wanted = due_of(due, key, row)
        text = plain(value) if digits is None or value is None else f"{value:.{digits}f}"
        if wanted is None:
            return text
        figure = f"due {wanted.sign} {wanted.for_row(row):g}"
        if value is None:
            return f"not measured ({figure})"
        return f"{text} ({figure})" if wanted.met(row) else f"**{text}** ({figure}: missed)"

    return cell


def same(*keys: str) -> dict[str, Cell]:
    """Columns that are headed by the keys of their values."""
    return {key: of(key) for key in keys}


def centimetres(row: Row) -> str:
    """The edge of a voxel."""
    return "" if row.get("voxel_size_m") is None else f"{row['voxel_size_m'] * 100:g} cm"


def any_tables(rows: Sequence[Row]) -> list[str]:
    """All that rows say, a column each."""
    names = dict.fromkeys(key for row in rows for key in row if key not in ("kind", "voxel_size_m"))
    columns: dict[str, Cell] = {"voxel": centimetres} if any("voxel_size_m" in row for row in rows) else {}
    columns |= {name.replace("_pct", " %").replace("_", " "): of(name) for name in names}
    return table(rows, columns)
