"""`elbowroom evaluate looks`: false alarms on what is right, silence on what is wrong."""

import os
from itertools import chain
from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile


def looks(
    sites: Annotated[
        int, typer.Option(min=0, metavar="COUNT", help="Random sites that are as they should be.")
    ] = 200,
    wrong: Annotated[
        int, typer.Option(min=0, metavar="COUNT", help="Random sites that are made wrong in each kind.")
    ] = 20,
    rooms: Annotated[
        bool, typer.Option(help="Also the recordings and the rooms of the package, which are right.")
    ] = True,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of the recordings. Default: $ELBOWROOM_DATA, or else ../shared/data."
        ),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Count false alarms of the looks at values, and kinds of wrong input of which nothing is said.

    Right: recordings of the examples, rooms of the package, random simulated sites.
    Wrong: random sites, each made wrong in each kind.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.examples import EXAMPLES
    from elbowroom.evaluate.looks.looks import DUE, SCALED_KIND, looks_summary, right_rows, wrong_rows
    from elbowroom.evaluate.looks.rooms import package_scenes, recorded_scenes
    from elbowroom.evaluate.looks.scaled import SCALED

    folder = data or Path(os.environ.get("ELBOWROOM_DATA", "../shared/data"))
    known = chain(recorded_scenes(EXAMPLES, folder), package_scenes()) if rooms else ()
    rows = chain(right_rows(sites, known), wrong_rows(wrong), wrong_rows(wrong, SCALED, SCALED_KIND))
    show = as_table(
        {
            "kind": "{kind}",
            "scenes": "{scenes}",
            "stopped": text("{}", "stopped"),
            "named": text("{}", "named"),
            "unsaid": text("{}", "unsaid"),
            "refused": text("{}", "refused"),
            "warned": text("{}", "warned"),
        },
        sentence(DUE),
    )
    measured("scenes", rows, None, json, show, looks_summary)
