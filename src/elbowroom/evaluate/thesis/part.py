"""One experiment: what there is to do, what it comes to, what is shown of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from elbowroom.evaluate.due import Due
from elbowroom.evaluate.shares.task import Row, Settings, Task
from elbowroom.view.report.blocks import Block, Words


def about(docstring: str | None) -> Words:
    """What a module says of its experiment, but for the first line."""
    return Words(" ".join((docstring or "").split("\n\n", 1)[1].split()))


@dataclass(frozen=True, slots=True)
class Part:
    """One of the thesis' experiments.

    Args:
        name: as the command is called.
        title: of its section.
        tasks: what to do.
        summary: rows of kind "summary" from the tasks' rows.
        show: the section, from all rows of the part, summaries included, and the tasks' pictures by name.
        due: the figures that it should reach.
    """

    name: str
    title: str
    tasks: Callable[[Settings], list[Task]]
    summary: Callable[[Sequence[Row]], list[dict[str, object]]]
    show: Callable[[Sequence[Row], Mapping[str, bytes]], list[Block]] = field(repr=False)
    due: tuple[Due, ...] = ()
