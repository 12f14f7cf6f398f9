"""`elbowroom evaluate escape`: poses a few millimetres beside an object, and which motions are let go."""

from typing import Annotated

import typer

from elbowroom.cli.evaluate.options import OneVoxelSize, Seed
from elbowroom.cli.options import JsonFile

QUICK = 24
"""Poses of a quick run."""


def escape(
    poses: Annotated[int, typer.Option(min=12, metavar="COUNT", help="How many, over twelve scenes.")] = 300,
    voxel_size: OneVoxelSize = 0.02,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK} poses only.")] = False,
    seed: Seed = 5,
    json: JsonFile = None,
) -> None:
    """Check all motions of poses 0.3 to 20 mm beside an object against exact mesh distance (coal).

    The C-arm in six rooms, and the arm of examples/arm_on_a_table among things. Space is the truth
    in voxels, and again in parts of those that are asked again, as images are. Motions that lead away must go; none may
    be announced, or go, into what stands there.
    """
    from elbowroom.cli.evaluate.measured import measured
    from elbowroom.cli.evaluate.shown import as_table
    from elbowroom.evaluate.due import sentence
    from elbowroom.evaluate.escape.escape import DUE, escape_rows, escape_summary

    counts = ("poses", "motions", "leads_away", "refused", "escapes", "beyond", "touching")
    show = as_table(
        {
            "space": "{space}",
            "machine": "{machine}",
            **{name.replace("_", " "): f"{{{name}}}" for name in counts},
        },
        sentence(DUE),
    )
    count = QUICK if quick else poses
    rows = escape_rows(count, voxel_size_m=voxel_size, seed=seed)
    measured("verdicts", rows, None, json, show, escape_summary)
