"""`elbowroom calibrate refine`: cameras moved until what they see in common fits together."""

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


def refine(
    site: SiteOrFolder,
    out: OutSite,
    report: ReportFolder = None,
    camera: Only = None,
    hold: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="This camera's pose holds exactly; may be given more than once."),
    ] = None,
    sure_to: Annotated[
        str | None,
        typer.Option(
            metavar="MM,DEGREES",
            help="How sure the poses are of which the site says no covariance, one sigma along each axis: 50,3.",
        ),
    ] = None,
    confidence: Confidence = 0.95,
    near: Near = None,
    force_file: ForceFile = False,
    json: JsonFile = None,
) -> None:
    """Move cameras until the walls, the floor and the furniture that they see in common fit together.

    No camera moves farther than the covariance of its pose allows (99 %); one that wants to is named, and nothing is
    written. The recording shows the room in one or more moments; people may walk in it.
    """
    from elbowroom.cli.calibrate.refine_run import RefineOptions, run_refine
    from elbowroom.cli.calibrate.result import ResultOptions

    options = RefineOptions(
        site=site,
        only=tuple(camera or ()),
        hold=tuple(hold or ()),
        sure_to=sure_to,
        result=ResultOptions(
            out=out, report=report, confidence=confidence, near_m=near, force_file=force_file
        ),
    )
    run_refine(options, json)
