"""The runs of the thesis' experiments: tasks spread over cores or computers, tables to the screen, a page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from elbowroom.cli.evaluate.measured import watched
from elbowroom.errors import InputError
from elbowroom.evaluate.shares.kept import Kept, source_state
from elbowroom.evaluate.shares.task import Outcome, Settings, Task
from elbowroom.evaluate.shares.work_force import do_tasks
from elbowroom.evaluate.thesis.due import due_table
from elbowroom.evaluate.thesis.part import Part
from elbowroom.evaluate.thesis.thesis import SENSORS
from elbowroom.files.atomic import folder, whole_file
from elbowroom.files.json_rows import json_rows, meta
from elbowroom.geometry.parallel import default_threads
from elbowroom.view.report.blocks import Block, Table
from elbowroom.view.report.page import page
from elbowroom.view.report.tables import rich_table

Section = tuple[str, list[Block]]
TITLE = "The thesis' experiments"
ABOUT = (
    "I. Hamersma, *Collision avoidance using multiple correlated 3D depth measurements*, Eindhoven 2011, "
    "run again with elbowroom: its figures stand beside ours."
)


@dataclass(frozen=True, slots=True)
class Spread:
    """Where the work goes: processes on this computer, or the address of a Dask scheduler."""

    jobs: int | None
    cluster: str | None


def settings(**given: Any) -> Settings:
    """Settings from what the command line says; what it does not say is as usual.

    Raises:
        InputError: an unknown sensor.
    """
    for sensor in given.get("sensors") or ():
        if sensor not in SENSORS:
            raise InputError(f"--sensor: {sensor!r} is unknown, allowed are {', '.join(SENSORS)}")
    said: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in given.items()
        if value is not None
    }
    return Settings(**said)


def run_parts(
    parts: Sequence[Part], given: Settings, spread: Spread, out: Path | None, json: Path | None
) -> None:
    """Does the tasks of some parts, shows their tables, writes page and results.

    Args:
        parts: of the thesis' experiments.
        given: how much of them is run.
        spread: where the work goes.
        out: folder for the page and what is done; None: no page.
        json: file for the rows.

    Raises:
        InputError: a folder that cannot be written to, no scheduler at the address.
        PackageError: an extra is not installed.
    """
    # at once: a result file that is written into the checkout makes it differ from its commit
    said = meta()
    if out is not None:
        folder(out)
    kept = Kept(out / "parts" if out else None, source_state())
    tasks = [task for part in parts for task in part.tasks(given)]
    if not tasks:
        raise InputError("evaluate: nothing to do with these options; ask for more")
    with json_rows(json) as add:
        outcomes = _done(tasks, kept, spread)
        sections: list[Section] = []
        every: list[dict[str, Any]] = []
        for part in parts:
            rows, pictures = _of_part(part, tasks, outcomes)
            for row in rows:
                add(row)
            every += rows
            sections.append((part.title, part.show(rows, pictures)))
    due = due_table(parts, every)
    if due is not None:
        sections.insert(0, (due.title, [due]))
    _print(sections)
    if out is not None:
        with whole_file(out / "report.html") as unfinished:
            unfinished.write_text(page(TITLE, ABOUT, sections, said), encoding="utf-8")
        print(f"\nPage: {out / 'report.html'}")


def _print(sections: Sequence[Section]) -> None:
    """Titles and tables."""
    console = Console(highlight=False)
    for title, blocks in sections:
        console.print(f"\n{title}", style="bold")
        for block in blocks:
            if isinstance(block, Table):
                console.print(rich_table(block))


def _done(tasks: Sequence[Task], kept: Kept, spread: Spread) -> dict[int, Outcome]:
    """The outcome of each task by its index: kept ones taken, the others done."""
    outcomes = {n: found for n, task in enumerate(tasks) if (found := kept.load(task)) is not None}
    left = [n for n in range(len(tasks)) if n not in outcomes]
    if outcomes:
        Console(stderr=True, highlight=False).print(
            f"{len(outcomes)} of {len(tasks)} shares are there already"
        )
    doing = do_tasks([tasks[n] for n in left], jobs=spread.jobs or default_threads(), cluster=spread.cluster)
    try:
        for index, outcome in watched("shares", doing, len(left)):
            outcomes[left[index]] = kept.keep(tasks[left[index]], outcome)
    except KeyboardInterrupt:
        where = (
            f"kept in {kept.path}; the same command goes on from there"
            if kept.path
            else "lost; --out DIR keeps them"
        )
        Console(highlight=False).print(
            f"Interrupted after {len(outcomes)} of {len(tasks)} shares of the work. They are {where}.",
            soft_wrap=True,
        )
        raise
    return outcomes


def _of_part(
    part: Part, tasks: Sequence[Task], outcomes: Mapping[int, Outcome]
) -> tuple[list[dict[str, Any]], dict[str, bytes]]:
    """Rows in the order of the tasks, whoever was done first, then their summary; pictures by name."""
    mine = [outcomes[n] for n, task in enumerate(tasks) if task.part == part.name]
    rows = [row for outcome in mine for row in outcome.rows]
    pictures = {name: png for outcome in mine for name, png in outcome.pictures.items()}
    return [{"part": part.name, **row} for row in rows + part.summary(rows)], pictures
