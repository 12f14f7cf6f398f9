"""The run of `elbowroom evaluate bits`: sums to the file, a line a case to the screen, compared with a kept file."""

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.table import Table

from elbowroom.cli.evaluate.measured import watched
from elbowroom.errors import InputError
from elbowroom.evaluate.bits.cases import absent, cases
from elbowroom.evaluate.bits.sums import Case, Row, differences, sum_of
from elbowroom.evaluate.examples import EXAMPLES
from elbowroom.files.json_rows import json_rows, meta

SHOWN = 10
"""So many differences are named one by one."""


def run_bits(
    examples: Path | None, data: Path | None, quick: bool, against: Path | None, json: Path | None
) -> None:
    """Takes the sums, shows them, writes them, compares them.

    Args:
        examples: folder of site files of recordings; None: that of a checkout, if this runs from one.
        data: folder of the recordings; None: ELBOWROOM_DATA, or where the site files look.
        quick: a few cases only.
        against: a file that this command wrote before; None: nothing is compared.
        json: the file to write; None: none.

    Raises:
        InputError: a file to compare with that cannot be read.
        typer.Exit: 1, where rows differ.
    """
    kept = None if against is None else kept_rows(against)
    examples = examples or _examples()
    if data is not None:
        os.environ["ELBOWROOM_DATA"] = str(data.absolute())
    data = _data(examples)
    every = cases(examples, data)
    taken = [case for case in every if case.quick or not quick]
    rows: list[Row] = []
    with json_rows(json) as add:
        for each in watched("cases", ([*case.rows()] for case in taken), len(taken)):
            for row in each:
                add(row)
            rows += each
    console = Console(highlight=False)
    console.print(_table(taken, rows))
    missing = absent(examples, data)
    if missing:
        _say(console, f"Left out, their data is not there (--data DIR): {', '.join(missing)}.")
    if kept is not None and against is not None:
        left_out = {case.name for case in every} - {case.name for case in taken} | set(missing)
        _compare(console, rows, kept, left_out, against)


def kept_rows(path: Path) -> list[dict[str, Any]]:
    """The rows of a file that the command wrote.

    Raises:
        InputError: there is none, or it is something else.
    """
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))["rows"]
        if not all("sha256" in row and "free_pct" in row and "case" in row for row in rows):
            raise KeyError
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"--against: {path} is no file that elbowroom evaluate bits --json wrote") from error
    return list(rows)


def _compare(
    console: Console, rows: Sequence[Row], kept: Sequence[Row], left_out: set[str], against: Path
) -> None:
    found = differences(rows, kept, left_out)
    asked = len(rows) + sum(words.endswith("in the kept file only") for words in found)
    for words in found[:SHOWN]:
        _say(console, words)
    if len(found) > SHOWN:
        _say(console, f"... and {len(found) - SHOWN} more")
    not_asked = sum(row["case"] in left_out for row in kept)
    rest = f"; {not_asked} more of it belong to cases that were left out" if not_asked else ""
    _say(console, f"{asked - len(found)} of {asked} the same as in {against}{rest}.")
    if found:
        here, there = meta()["processor"], json.loads(against.read_text(encoding="utf-8")).get("meta", {})
        if there.get("processor") not in (None, here):
            _say(
                console,
                f"That file is of another processor ({there['processor']}; here {here}): simulated images may "
                "differ in their last bits, and all that is made of them. Compare with one that was written here.",
            )
        raise typer.Exit(1)


def _table(taken: Sequence[Case], rows: Sequence[Row]) -> Table:
    """A line a case: how many sums, and the sum of them."""
    table = Table(box=None, pad_edge=False)
    table.add_column("case")
    table.add_column("sums", justify="right")
    table.add_column("all of them")
    for case in taken:
        sums = [row["sha256"] for row in rows if row["case"] == case.name]
        table.add_row(case.name, str(len(sums)), sum_of([("sums", " ".join(sums))])[:16])
    return table


def _say(console: Console, words: str) -> None:
    console.print(words, soft_wrap=True)


def _examples() -> Path | None:
    """examples/ of the checkout that this code runs from."""
    return EXAMPLES if EXAMPLES.is_dir() else None


def _data(examples: Path | None) -> Path | None:
    """Where the examples' site files look for recordings."""
    named = os.environ.get("ELBOWROOM_DATA")
    if named:
        return Path(named).absolute()
    return None if examples is None else (examples / "../../shared/data").resolve()
