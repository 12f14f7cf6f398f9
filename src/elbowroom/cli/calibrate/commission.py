"""`elbowroom calibrate commission`: what stands still, so that a camera that moves is noticed."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.options import JointsText, JsonFile, parse_joints


def commission(
    out: Annotated[
        Path, typer.Option("--out", metavar="SITE", help="The new site file, in the old one's folder.")
    ],
    site: Annotated[
        Path | None, typer.Argument(metavar="SITE", help="A site file. Default: the simulated room.")
    ] = None,
    frames: Annotated[int, typer.Option(min=5, max=200, help="Moments to look at.")] = 20,
    every: Annotated[
        float, typer.Option(min=0.01, metavar="SECONDS", help="In a simulated room, how far apart they are.")
    ] = 0.7,
    joints: JointsText = None,
    json: JsonFile = None,
) -> None:
    """Look at the room as it is, and write what stands still beside a new site file with the key `watch`.

    People may walk through; nothing that is fixed may be moved meanwhile. The
    machine's pixels do not count. `elbowroom monitor` with the new site file then
    stops where a camera has moved, or the machine is not where its joints say.
    """
    from elbowroom.cli.calibrate.commission_run import run_commission

    run_commission(
        path=site, out=out, frames=frames, every_s=every, joints=parse_joints(joints), json_file=json
    )
