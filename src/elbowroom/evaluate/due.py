"""What the project set out to reach: each figure is written once, beside the experiment that measures it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

Row = Mapping[str, Any]
Sign = Literal["≥", "≤"]
UNITS = {"_pct": " %", "_ms": " ms", "_mm": " mm", "_s": " s", "_mb": " MB", "_voxels": " voxels"}
"""By the end of a value's key."""
FULL_ROOM: Row = {"cameras": 21, "width": 640, "height": 480}
"""The cameras that most figures of the simulated room speak of."""


def every(row: Row) -> bool:
    """Any row at all."""
    return True


def where(**values: Any) -> Callable[[Row], bool]:
    """Rows that have these values."""
    return lambda row: all(row.get(key) == value for key, value in values.items())


@dataclass(frozen=True, slots=True)
class Due:
    """A figure that some rows of an experiment should reach.

    Args:
        key: of the value in a row.
        sign: "≥": at least the figure; "≤": at most.
        figure: in the unit that the key ends with; or a function of the row.
        of: the rows of which it is due.
        words: which value and rows these are, as a sentence says it.
    """

    key: str
    sign: Sign
    figure: float | Callable[[Row], float]
    of: Callable[[Row], bool] = every
    words: str = ""

    def for_row(self, row: Row) -> float:
        """The figure that is due of a row."""
        return self.figure(row) if callable(self.figure) else self.figure

    def met(self, row: Row) -> bool:
        """Whether a row reaches it; not where it has no value."""
        value, figure = row.get(self.key), self.for_row(row)
        return value is not None and bool(value >= figure if self.sign == "≥" else value <= figure)

    @property
    def said(self) -> str:
        """In words, such as "10 % at most"; a count of which none may be is "0".

        Raises:
            TypeError: each row has a figure of its own.
        """
        if callable(self.figure):
            raise TypeError(f"{self.key}: each row has a figure of its own")
        if self.figure == 0:
            return "0"
        unit = next((unit for end, unit in UNITS.items() if self.key.endswith(end)), "")
        return f"{self.figure:g}{unit} at {'least' if self.sign == '≥' else 'most'}"


def due_of(dues: Sequence[Due], key: str, row: Row | None = None) -> Due | None:
    """The first figure that is due of a value.

    Args:
        dues: of an experiment.
        key: of the value.
        row: in which it stands; None: in any.

    Returns:
        None: nothing is due of it.
    """
    return next((due for due in dues if due.key == key and (row is None or due.of(row))), None)


def figure_of(dues: Sequence[Due], key: str) -> float:
    """The figure that is due of a value in any row."""
    due = due_of(dues, key)
    assert due is not None and not callable(due.figure)
    return due.figure


def sentence(dues: Sequence[Due], when: str = "") -> str:
    """All that is due, in words.

    Args:
        dues: of an experiment, each with its words.
        when: what holds of all of them, such as "with 21 cameras".
    """
    return f"Due{' ' + when if when else ''}: {'; '.join(f'{due.words} {due.said}' for due in dues)}."
