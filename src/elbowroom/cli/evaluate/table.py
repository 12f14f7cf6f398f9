"""`elbowroom evaluate table`: an arm that stands on a table, with declared contact or without."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Seed
from elbowroom.cli.options import JsonFile


def table(
    urdf: Annotated[
        Path, typer.Argument(metavar="URDF", help="The arm, such as the UR5 of example-robot-data.")
    ],
    link: Annotated[
        list[str],
        typer.Option("--link", metavar="NAME", help="A link that may be near the table; may be repeated."),
    ],
    poses: Annotated[int, typer.Option(min=1, metavar="COUNT", help="Random poses.")] = 40,
    voxel_size: Annotated[
        float, typer.Option(min=0.005, max=0.2, metavar="METRES", help="Edge of a voxel.")
    ] = 0.02,
    size: Annotated[
        str, typer.Option(metavar="WxH", help="Of images: 200x150, 424x240 or 848x480.")
    ] = "424x240",
    seed: Seed = 0,
    json: JsonFile = None,
) -> None:
    """Ask shoulder and elbow of an arm on a table how far they may go, seen by six noisy cameras; beside mesh distance.

    The noise is that of a RealSense D435. Links beside the table lie within the cameras' margin of it: without declared
    contact nearly all motions stop.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.errors import InputError
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.table.cell import SIZES
    from elbowroom.evaluate.table.table import DUE, table_rows, table_summary

    if size not in SIZES:
        raise InputError(f"--size: {size!r} is none of {', '.join(SIZES)}")
    counts = ("contact", "poses", "motions", "clear", "stop_where_clear", "within", "milder", "beyond")
    columns = {name.replace("_", " "): f"{{{name}}}" for name in counts}
    show = as_table({**columns, "of clear ones stop": "{stop_where_clear_pct:.1f} %"}, sentence(DUE))
    rows = table_rows(urdf, link, poses, voxel_size, size, seed)
    measured("verdicts", rows, 12 * poses, json, show, table_summary)
