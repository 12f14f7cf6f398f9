"""All figures of placement."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from elbowroom.errors import InputError
from elbowroom.evaluate.placement import layouts, prediction
from elbowroom.evaluate.placement.effort import FULL, Effort

DUE = layouts.DUE | prediction.DUE
"""What is due, by the kind of row."""
PARTS: Mapping[str, Callable[[Effort], Iterator[dict[str, Any]]]] = {
    "verify": layouts.verify_rows,
    "sweep": layouts.sweep_rows,
    "optimise": layouts.optimise_rows,
    "room": prediction.room_rows,
    "setups": prediction.setup_rows,
}
ROWS = {"verify": 1, "sweep": 1, "optimise": 2, "room": 2, "setups": 1}
"""How many rows each part has."""


def placement_rows(parts: Sequence[str] = tuple(PARTS), effort: Effort = FULL) -> Iterator[dict[str, Any]]:
    """The figures of some parts, one after the other.

    Args:
        parts: names of `PARTS`.
        effort: how much is measured.

    Yields:
        Rows of kind "verify", "sweep", "optimise" and "prediction".

    Raises:
        InputError: a part that is none.
        PackageError: the solver of the optimisation is not installed.
    """
    for part in parts:
        if part not in PARTS:
            raise InputError(f"part: {part!r} is unknown; parts are {', '.join(PARTS)}")
    for part in parts:
        yield from PARTS[part](effort)
