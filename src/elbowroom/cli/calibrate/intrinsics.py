"""`elbowroom calibrate intrinsics`: how each camera sees, from a board."""

from typing import Annotated, Literal

import typer

from elbowroom.cli.calibrate.options import ForceFile, OutSite, ReportFolder, SiteOrFolder
from elbowroom.cli.options import JsonFile


def intrinsics(
    site: SiteOrFolder,
    out: OutSite,
    report: ReportFolder = None,
    camera: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Only this camera; may be given more than once. Default: all."),
    ] = None,
    distortion: Annotated[
        Literal["0", "5", "8"],
        typer.Option(help="Coefficients; 0 where the driver delivers pinhole images already."),
    ] = "5",
    force_file: ForceFile = False,
    json: JsonFile = None,
) -> None:
    """Find focal length, principal point, distortion, depth scale and bias of each camera, and how sure they are.

    The site's key calibration names the board and its images. Poses stay as they are: go on with extrinsics.
    """
    from elbowroom.cli.calibrate.intrinsics_run import IntrinsicsOptions, run_intrinsics

    options = IntrinsicsOptions(
        site=site,
        out=out,
        report=report,
        only=tuple(camera or ()),
        coefficients=int(distortion),
        force_file=force_file,
    )
    run_intrinsics(options, json)
