"""`elbowroom evaluate own-links`: whether published robots are stopped before they meet themselves, and only then."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Seed
from elbowroom.cli.options import JsonFile

QUICK = (5, 3)
"""Robots and poses of a quick run."""


def own_links(
    folders: Annotated[
        list[Path],
        typer.Argument(metavar="FOLDER...", help="Folders in which packages of robots were unpacked."),
    ],
    robots: Annotated[
        int, typer.Option(min=1, metavar="COUNT", help="So many robots, one of a package.")
    ] = 30,
    poses: Annotated[int, typer.Option(min=1, metavar="COUNT", help="Random poses of each.")] = 20,
    quick: Annotated[bool, typer.Option("--quick", help="5 robots in 3 poses.")] = False,
    seed: Seed = 0,
    json: JsonFile = None,
) -> None:
    """Ask every joint of published robots, in random poses, how far it may go until links meet; against mesh distance.

    Motions that meet a link within the braking distance S must stop; others must not. S is 0.25 rad or 0.1 m. Robots
    with collision meshes are in example-robot-data, for one (PyPI).
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.own_links.own_links import DUE, own_link_rows, own_link_summary

    counts = ("robots", "poses", "motions", "meet", "called_clear", "beyond", "stops", "false_stops")
    columns = {name.replace("_", " "): f"{{{name}}}" for name in counts}
    last = {"false stops of clear ones": "{false_stops_pct:.2f} %", "ms a pose": "{ms_a_pose}"}
    many, often = QUICK if quick else (robots, poses)
    rows = own_link_rows(folders, many, often, seed)
    measured("robots", rows, many, json, as_table({**columns, **last}, sentence(DUE)), own_link_summary)
