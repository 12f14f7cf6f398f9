"""What a report shows: words, tables and pictures, for the terminal and for the page alike."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Words:
    """A paragraph."""

    text: str


@dataclass(frozen=True, slots=True)
class Table:
    """A table.

    Args:
        title: above it.
        columns: names.
        lines: cells as text, one sequence a line.
        left: columns that are words and stand to the left, by index.
    """

    title: str
    columns: Sequence[str]
    lines: Sequence[Sequence[str]]
    left: Sequence[int] = (0,)


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture.

    Args:
        png: the file's bytes.
        caption: below it.
        width_px: as shown.
    """

    png: bytes
    caption: str
    width_px: int = 480


Block = Words | Table | Picture


def pct(value: float | None, digits: int = 2) -> str:
    """Per cent as text; rounded down, so that 99.9999 does not read as 100; "-" for None."""
    if value is None:
        return "-"
    scale = 10.0**digits
    return f"{int(value * scale + 1e-9) / scale:.{digits}f}"


def cm(metres: float) -> str:
    """A length in centimetres as text."""
    return f"{metres * 100:g} cm"


def mean(values: Sequence[float]) -> float | None:
    """None of nothing."""
    return sum(values) / len(values) if values else None
