"""`elbowroom calibrate commission`: what stands still, so that a camera that moves is noticed."""

from pathlib import Path
from typing import Annotated

import typer

from elbowroom.cli.calibrate.options import ForceFile
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
    force_file: ForceFile = False,
    json: JsonFile = None,
) -> None:
    """Look at the room as it is, and write what stands still beside a new site file with the key `watch`.

    People may walk through; nothing that is fixed may be moved meanwhile. The
    machine's pixels do not count. `elbowroom monitor` with the new site file then
    stops where a camera has moved, or the machine is not where its joints say.

    Images that cannot be meant so, cameras that contradict each other, and a camera
    whose view tells none of its motions are no result.
    """
    from elbowroom.cli.calibrate.commission_run import CommissionOptions, run_commission

    options = CommissionOptions(
        path=site, out=out, frames=frames, every_s=every, joints=parse_joints(joints), force_file=force_file
    )
    run_commission(options, json)
