"""`elbowroom evaluate paths`: how far random paths may be followed, beside exact geometry."""

from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import OneVoxelSize, Seed
from elbowroom.cli.options import JsonFile

QUICK_PATHS = 5
ROWS_A_PATH = 2
"""One by each way of braking."""


def paths(
    count: Annotated[int, typer.Option("--paths", min=1, metavar="COUNT", help="Paths of the UR5.")] = 200,
    c_arm: Annotated[
        int | None, typer.Option(min=1, metavar="COUNT", help="Paths of the C-arm. Default: as many.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_PATHS} paths of each.")] = False,
    voxel_size: OneVoxelSize = 0.02,
    seed: Seed = 1,
    json: JsonFile = None,
) -> None:
    """Compare how far random paths of a UR5 and of the C-arm may be followed with exact mesh distance.

    In the volume of exact truth, without cameras. Once with brakes along the path: then
    the truth is the first contact on it. Once with each joint braking by itself: then
    stops are tried before what is said to be safe, where none may touch anything, and
    beyond, until one does. The UR5 comes with the package example-robot-data.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table, text
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.paths.rows import DUE, path_rows, path_summary

    show = as_table(
        {
            "machine": "{machine}",
            "brakes": "{brakes}",
            "paths": "{paths}",
            "free": "{free_to_the_end}",
            "beyond the truth": "{beyond}",
            "compared": "{compared}",
            "median shortfall": text("{:.2f} voxels", "median_shortfall_voxels"),
            "greatest": text("{:.2f} voxels", "greatest_shortfall_voxels"),
        },
        sentence(DUE),
    )
    many = QUICK_PATHS if quick else count
    others = min(many, c_arm or many)
    rows = path_rows({"UR5": many, "C-arm": others}, voxel_size_m=voxel_size, seed=seed)
    measured("paths", rows, ROWS_A_PATH * (many + others), json, show, path_summary)
