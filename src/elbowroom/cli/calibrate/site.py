"""The site that a command of `elbowroom calibrate` is given, and which of its cameras."""

from collections.abc import Sequence
from pathlib import Path

from elbowroom.errors import InputError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.site import Site

SITE_IN_FOLDER = "site.yaml"


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
    require_known("--camera", only, [camera.name for camera in cameras])
    return tuple(camera for camera in cameras if not only or camera.name in only)


def require_known(option: str, named: Sequence[str], cameras: Sequence[str]) -> None:
    """Checks the names of cameras that an option was given.

    Args:
        option: as it is typed.
        named: what was given.
        cameras: names of all that it may be.

    Raises:
        SiteError: a name that is none of them.
    """
    unknown = sorted(set(named) - set(cameras))
    if unknown:
        raise SiteError(f"{option}: no camera {unknown[0]!r}; cameras are {', '.join(cameras)}")
