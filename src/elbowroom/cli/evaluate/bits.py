"""`elbowroom evaluate bits`: whether a change of the code changed a bit."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile


def bits(
    examples: Annotated[
        Path | None,
        typer.Argument(metavar="EXAMPLES", help="Folder of site files. Default: examples of a checkout."),
    ] = None,
    data: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of the recordings. Default: ELBOWROOM_DATA, or as the site files say."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A few cases only.")] = False,
    against: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="A file that this command wrote before; exits with 1 if rows differ."
        ),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Check sums of free space and verdicts, by every rule and detail: whether a change of the code changed a bit."""
    from elbowroom.cli.evaluate.bits_run import run_bits

    run_bits(examples, data, quick, against, json)
