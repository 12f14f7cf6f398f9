"""`elbowroom calibrate extrinsics`: where the cameras are, from a board that several see at a time."""

from typing import Annotated

import typer

from elbowroom.cli.calibrate.options import Confidence, ForceFile, Near, OutSite, ReportFolder, SiteOrFolder
from elbowroom.cli.options import JsonFile


def extrinsics(
    site: SiteOrFolder,
    out: OutSite,
    report: ReportFolder = None,
    without_pose: Annotated[
        list[int] | None,
        typer.Option(metavar="NUMBER", help="Leave a pose of the board out; may be given more than once."),
    ] = None,
    confidence: Confidence = 0.95,
    near: Near = None,
    force_file: ForceFile = False,
    json: JsonFile = None,
) -> None:
    """Find where the cameras are from a board that two or more of them see at a time, and how sure that is.

    The site's key calibration names the board, its images, and what fixes the world: the board flat in one pose, points
    that were measured (corners of the board in several poses, or points in images), or a camera that stays where it
    is. Intrinsics are the site's: calibrate those first.
    """
    from elbowroom.cli.calibrate.extrinsics_run import ExtrinsicsOptions, run_extrinsics
    from elbowroom.cli.calibrate.result import ResultOptions

    result = ResultOptions(out=out, report=report, confidence=confidence, near_m=near, force_file=force_file)
    options = ExtrinsicsOptions(site=site, without_poses=tuple(without_pose or ()), result=result)
    run_extrinsics(options, json)
