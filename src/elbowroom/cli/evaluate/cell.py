"""`elbowroom evaluate cell`: a robot arm in its cell, and which truly clear motions the cameras stop."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import Seed
from elbowroom.cli.options import JsonFile, VoxelSize

QUICK_POSES = 20
Poses = Annotated[
    int, typer.Option(min=1, metavar="COUNT", help="How many poses, at random and at work in turn.")
]


def cell(
    site: Annotated[
        Path | None,
        typer.Argument(
            metavar="SITE", help="A site file with a machine and a room. Default: a UR5 on a table."
        ),
    ] = None,
    poses: Poses = 200,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_POSES} poses.")] = False,
    exact: Annotated[
        bool, typer.Option("--exact", help="Images without noise, and no margin for it.")
    ] = False,
    voxel_size: VoxelSize = None,
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Compare verdicts of an arm's motions with exact geometry: which truly clear ones stop, and for what cause.

    Poses that touch nothing, a person beside the arm, images with the site's noise.
    The UR5 comes with the package example-robot-data; its poses are drawn at random
    and at work, with the tool down over the table, and shoulder and elbow are told
    apart from the wrist. Any other site is measured in random poses.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.cell.rows import DUE, STOPPING, cell_rows, cell_summary
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.tables import Cell

    columns: dict[str, Cell] = {
        "table": "{contact}",
        "joints": "{joints}",
        "poses": "{kind_of_pose}",
        "motions": "{motions}",
        "milder": "{milder_level}",
        "own links": "{milder_own}",
        "truly clear": "{truly_clear}",
        "of these stop": text("{:.1f} %", "stop_where_clear_pct"),
        **{f"by {c.name.lower()}": f"{{stopped_by_{c.name.lower()}}}" for c in STOPPING},
    }
    count = QUICK_POSES if quick else poses
    rows = cell_rows(
        site,
        poses=count,
        kinds=("random", "work") if site is None else ("random",),
        voxel_size_m=voxel_size,
        noise=not exact,
        seed=seed,
    )
    measured("verdicts", rows, None, json, as_table(columns, sentence(DUE)), cell_summary)
