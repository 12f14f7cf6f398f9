"""`elbowroom gate`: what the gate of a running monitor says, and a person's reset."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from elbowroom.cli.options import JsonFile

if TYPE_CHECKING:
    from collections.abc import Mapping

gate_app = typer.Typer(
    help="Ask the gate of a running monitor, and reset it.",
    epilog="Begin with: elbowroom monitor --gate my_gate",
    no_args_is_help=True,
)
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="The gate's folder, as given to the monitor.")]


@gate_app.command(epilog="Example: elbowroom gate status my_gate")
def status(folder: Folder, json: JsonFile = None) -> None:
    """Say where the gate stands, what is latched, and what each motion may do.

    It asks the monitor that runs with this folder.
    """
    from elbowroom.files.json_rows import write_json
    from elbowroom.guard.control import ask

    told = ask(folder, "status")
    write_json(json, [{"kind": "gate", **told}])
    _print(told)


@gate_app.command(epilog="Example: elbowroom gate reset my_gate")
def reset(folder: Folder, json: JsonFile = None) -> None:
    """Forget faults that are over. Refused, with exit code 1, while one is there.

    It starts nothing: the machine stays stopped until the next pass, then speed
    rises slowly. Only who owns the folder may, and only on this computer.
    """
    from elbowroom.files.json_rows import write_json
    from elbowroom.guard.control import ask

    told = ask(folder, "reset")
    write_json(json, [{"kind": "gate", **told}])
    print(told["answer"])
    if not told["reset"]:
        raise typer.Exit(1)


@gate_app.command(epilog="Example: elbowroom gate token my_token")
def token(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A new file, which its owner alone can read.")],
) -> None:
    """Make a token for the control service of a monitor (`monitor --service`).

    Who can read the file may reset the gate and hold on, on this computer.
    """
    from elbowroom.service.token import made_token

    made_token(file)
    print(f"{file} written; whoever can read it may reset the gate")


def _print(told: "Mapping[str, Any]") -> None:
    """What the monitor answered, in lines."""
    print(f"{told['site']}: {told['phase']}, {told['level']}, {100 * told['speed']:.0f} % of full speed")
    active = [(fault["reason"], fault["subject"]) for fault in told["active"]]
    for fault in told["latched"]:
        is_there = (fault["reason"], fault["subject"]) in active
        print(f"  {'there now' if is_there else 'over, waits for a reset'}: {fault['text']}")
    for name, motion in told["motions"].items():
        print(f"  {name}: {motion['level']}, {100 * motion['speed']:.0f} %, {motion['reason']}")
    for output in told["outputs"]:
        print(f"  told to: {output}")
