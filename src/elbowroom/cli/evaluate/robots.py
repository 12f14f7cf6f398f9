"""`elbowroom evaluate robots`: whether robots that others published load, and lose no part unsaid."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JsonFile


def robots(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="FOLDER...", help="Folders in which packages of robots were unpacked."),
    ],
    leave_out: Annotated[
        list[str] | None,
        typer.Option(metavar="WORD", help="Leave out files with this word in their path; may be repeated."),
    ] = None,
    json: JsonFile = None,
) -> None:
    """Load and pose every URDF and xacro file below folders; count those that load, are refused, lose a part unsaid."""
    from elbowroom.cli.evaluate.robots_run import run_robots

    run_robots(folders, tuple(leave_out or ()), json)
