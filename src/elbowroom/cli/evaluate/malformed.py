"""`elbowroom evaluate malformed`: whether any input from outside crashes, hangs or takes memory as it likes."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile

QUICK_MINUTES = 0.25


def malformed(
    minutes: Annotated[
        float, typer.Option(min=0.05, metavar="MINUTES", help="Of processor time, for each reader.")
    ] = 10.0,
    quick: Annotated[bool, typer.Option("--quick", help="A quarter of a minute for each.")] = False,
    only: Annotated[list[str] | None, typer.Option(help="This reader; may be repeated.")] = None,
    keep: Annotated[Path, typer.Option(metavar="DIR", help="For inputs that were found.")] = Path(
        "malformed"
    ),
    json: JsonFile = None,
) -> None:
    """Try every reader of input from outside with malformed input, led by coverage.

    MCAP, databases of rosbag2 and their metadata, recordings of a run, depth images,
    site files, joints, and the port of the Modbus server. Inputs begin as this
    package writes them. Anything but an error of this package is a crash; 2 s of
    processor time for one input, twice, is a hang; more than twice the memory that
    the code says is refused to it. A reader whose experiment dies is said in its row,
    and the next one begins. Needs atheris, on Linux.
    """
    from elbowroom.cli.evaluate.measured import measured, told
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.malformed.campaign import DUE, malformed_rows

    show = as_table(
        {
            "reader": "{target}",
            "processor": text("{:.0f} s", "cpu_s"),
            "inputs": "{inputs:,}",
            "branches": "{branches:,}",
            "crashes": "{crashes}",
            "hangs": "{hangs}",
            "allocations": "{allocations}",
            "first": lambda row: row["found"][0]["error"] if row["found"] else "",
        },
        sentence(DUE),
    )
    length = QUICK_MINUTES if quick else minutes
    rows = told(lambda tell: malformed_rows(length, tuple(only or ()), keep, tell))
    measured("readers", rows, None, json, show)
