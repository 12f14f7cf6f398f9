"""Arguments and options that the commands of `elbowroom calibrate` share."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from elbowroom.errors import InputError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site

SITE_IN_FOLDER = "site.yaml"

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


def site_path(given: Path) -> Path:
    """The site file that is meant: itself, or `site.yaml` in the folder.

    Raises:
        InputError: a folder without one.
    """
    if not given.is_dir():
        return given
    path = given / SITE_IN_FOLDER
    if not path.is_file():
        raise InputError(f"{given}: has no {SITE_IN_FOLDER} in it; name the site file itself")
    return path


def chosen_cameras(site: Site, only: Sequence[str]) -> tuple[DepthCamera, ...]:
    """The site's cameras, or those of them that are named.

    Raises:
        SiteError: the site lists none, or has none of that name.
    """
    cameras = site.cameras()
    unknown = sorted(set(only) - {camera.name for camera in cameras})
    if unknown:
        known = ", ".join(camera.name for camera in cameras)
        raise SiteError(f"--camera: no camera {unknown[0]!r}; cameras are {known}")
    return tuple(camera for camera in cameras if not only or camera.name in only)
