"""`elbowroom evaluate`: how right the answers are."""

import typer

from elbowroom.cli.options import JsonFile
from elbowroom.errors import ElbowroomError

evaluate_app = typer.Typer(help="Measure how right the answers are.", no_args_is_help=True)


@evaluate_app.command(epilog="Example: elbowroom evaluate room --json room.json")
def room(json: JsonFile = None) -> None:
    """Compare with the exact truth of the simulated room."""
    raise ElbowroomError("evaluate room: is not part of this version yet")


@evaluate_app.command(epilog="Example: elbowroom evaluate sevenscenes --json sevenscenes.json")
def sevenscenes(json: JsonFile = None) -> None:
    """Compare with views of a real room that were kept apart."""
    raise ElbowroomError("evaluate sevenscenes: is not part of this version yet")
