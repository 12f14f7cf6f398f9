"""`elbowroom calibrate machine`: where the cameras are, from the machine itself."""

from typing import Annotated

import typer

from elbowroom.cli.calibrate.options import (
    Confidence,
    ForceFile,
    Near,
    Only,
    OutSite,
    ReportFolder,
    SiteOrFolder,
)
from elbowroom.cli.options import JsonFile


def machine(
    site: SiteOrFolder,
    out: OutSite,
    report: ReportFolder = None,
    camera: Only = None,
    base: Annotated[
        bool,
        typer.Option(
            "--base",
            help="Find where the machine's base is as well; cameras that hold, or that are sure, fix the world.",
        ),
    ] = False,
    hold: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="With --base: this camera's pose holds; may be given more than once."
        ),
    ] = None,
    model_mm: Annotated[
        float,
        typer.Option(
            min=0.1, max=50.0, help="How well the machine's model fits the machine, in millimetres."
        ),
    ] = 2.0,
    confidence: Confidence = 0.95,
    near: Near = None,
    force_file: ForceFile = False,
    json: JsonFile = None,
) -> None:
    """Find where the cameras are from images of the machine in several poses, no board needed, and how sure that is.

    The recording has one moment per pose and joints.csv; 12 poses in which every joint moves are good. The cameras'
    poses in the site may be 10 cm and 5 degrees off. The machine's base fixes the world.
    """
    from elbowroom.cli.calibrate.machine_run import MachineOptions, run_machine
    from elbowroom.cli.calibrate.result import ResultOptions

    options = MachineOptions(
        site=site,
        only=tuple(camera or ()),
        base=base,
        hold=tuple(hold or ()),
        model_mm=model_mm,
        result=ResultOptions(
            out=out, report=report, confidence=confidence, near_m=near, force_file=force_file
        ),
    )
    run_machine(options, json)
