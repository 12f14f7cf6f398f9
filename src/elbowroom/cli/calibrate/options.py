"""Arguments and options that the commands of `elbowroom calibrate` share."""

from pathlib import Path
from typing import Annotated

import typer

SiteOrFolder = Annotated[
    Path,
    typer.Argument(metavar="SITE_OR_FOLDER", help="A site file (YAML), or a folder with a site.yaml in it."),
]
OutSite = Annotated[
    Path,
    typer.Option(
        "--out",
        metavar="SITE",
        help="The new site file; the old one stays, and no other file is overwritten.",
    ),
]
ReportFolder = Annotated[
    Path | None,
    typer.Option(
        "--report", metavar="DIR", help="Write a page with residuals and pictures into this folder."
    ),
]
Confidence = Annotated[
    float,
    typer.Option(min=0.5, max=0.9999, help="That nothing is displaced by more than a camera's margin."),
]
Near = Annotated[
    float | None,
    typer.Option(
        metavar="METRES",
        help="Lateral margins hold from this depth on. Default: 1, or a camera's least depth if that is more.",
    ),
]
ForceFile = Annotated[
    bool,
    typer.Option(
        "--force-file",
        help="Write what is no result all the same, to SITE's name with .doubted in it; the command fails as without.",
    ),
]
Only = Annotated[
    list[str] | None,
    typer.Option(
        "--camera",
        metavar="NAME",
        help="Only this one; may be given more than once. Others stay as they are.",
    ),
]
