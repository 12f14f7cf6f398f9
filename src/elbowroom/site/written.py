"""Site files that the program writes: the one place where they are put on disk, and how values stand in them."""

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.files.atomic import whole_file
from elbowroom.files.yaml_file import write_yaml
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import Margin
from elbowroom.site import Site
from elbowroom.site.paths import led_from
from elbowroom.site.schema import EVEN_SETTINGS

PATH_KEYS = ("intrinsics_file", "pose_file", "urdf", "srdf", "own_links", "mesh", "folder", "file", "mask")
"""Keys whose values are paths beside the site file."""
SHIPPED_ROOM = re.compile("setup[1-6]")
"""A mesh of this name is no file but a room of the package."""
DIGITS = 9


def written(content: Mapping[str, Any], out: Path, by: str, like: Site | None = None) -> Path:
    """Writes a site file and loads it again: what cannot be read is not called written.

    Args:
        content: what it says, key by key.
        out: the file.
        by: what wrote it, for the first line.
        like: the site that it says again: its comments stay, and the order of its keys; None: there is none.

    Returns:
        The path.

    Raises:
        SiteError: the content is no site.
        InputError: the folder cannot be written to.
    """
    write_yaml(out, content, by, None if like is None else (like.path, _meant(like)))
    return _checked(out)


def written_with_key(site: Site, key: str, value: Mapping[str, Any], out: Path, by: str) -> Path:
    """Writes a site's own text, comments and all, with one key said otherwise; it goes to the end.

    Paths stay as they are written, so the new file belongs into the old one's folder.

    Args:
        site: the old one.
        key: of the outermost mapping.
        value: its new mapping, of plain values.
        out: the new file.
        by: what wrote it, in a comment beside the key.

    Returns:
        The path.

    Raises:
        SiteError: the new file would be the site's own, or the result is no site.
        InputError: the folder cannot be written to.
    """
    refuse_own_file(site, out)
    old_key = re.compile(rf"^{re.escape(key)}:.*\n(?:[ \t]+.*\n|[ \t]*\n)*", re.MULTILINE)
    kept = old_key.sub("", site.path.read_text(encoding="utf-8")).rstrip()
    lines = "".join(f"  {name}: {said}\n" for name, said in value.items())
    with whole_file(out) as unfinished:
        unfinished.write_text(f"{kept}\n\n{f'{key}:':26}  # written by {by}\n{lines}", encoding="utf-8")
    return _checked(out)


def said_again(site: Site, out: Path) -> dict[str, Any]:
    """What a site says, for a file in another place that says what its cameras are.

    Paths lead from the new place to the same files. How a simulated room's cameras are made is left out.

    Args:
        site: the old one.
        out: the new file.

    Raises:
        SiteError: the new file would be the site's own.
    """
    refuse_own_file(site, out)
    content = _meant(site)
    if site.simulated is not None:
        content["simulated"] = {k: v for k, v in content["simulated"].items() if k not in EVEN_SETTINGS}
    return dict(moved(content, site.path.parent, out.absolute().parent))


def _meant(site: Site) -> dict[str, Any]:
    """What its file says, as plain values."""
    return dict(site.entry.model_dump(mode="json", exclude_unset=True))


def refuse_own_file(site: Site, out: Path) -> None:
    """Never over the file that a site was loaded from.

    Raises:
        SiteError: it is that file.
    """
    if out.exists() and out.samefile(site.path):
        raise SiteError(f"{out}: is the site file itself; write beside it, under another name")


def write_site(
    site: Site,
    cameras: Sequence[DepthCamera],
    path: Path,
    *,
    by: str = "placed by `elbowroom placement optimise`",
    room: Mapping[str, Any] | None = None,
) -> Path:
    """Writes the site again with these cameras in place of its own.

    All that the site says otherwise stays; paths are written so that they lead to the same files from the new place.
    Comments stay. Cameras stand with all that they are, so that nothing depends on `camera_defaults` any more.

    Args:
        site: what is taken over.
        cameras: all of the layout.
        path: the file to write; there must be none of that name but one that was written by the same means.
        by: what placed the cameras, for the first line.
        room: the key `room` otherwise, with paths from the new place; None: as it was.

    Returns:
        The path.

    Raises:
        SiteError: the new file would be the site's own.
        InputError: the folder cannot be written to.
    """
    content = {key: value for key, value in said_again(site, path).items() if key != "cameras"}
    if room is not None:
        content["room"] = plain(dict(room))
    content["cameras"] = [camera_entry(camera) for camera in cameras]
    if site.simulated is not None:
        content.pop("camera_defaults", None)
    return written(content, path, f"{site.name}: {len(cameras)} cameras, {by}", site)


def _checked(out: Path) -> Path:
    site = Site.load(out)
    if site.lists_cameras:
        site.cameras()
    return out


def camera_entry(camera: DepthCamera) -> dict[str, Any]:
    """A camera as a site file says it, with every key that is not as by default."""
    k = camera.intrinsics
    entry: dict[str, Any] = {
        "name": camera.name,
        "width": camera.width,
        "height": camera.height,
        "fx": k.fx,
        "fy": k.fy,
        "cx": k.cx,
        "cy": k.cy,
        "world_from_camera": matrix_entry(camera.world_from_camera),
        "depth_kind": camera.depth_kind,
        "min_depth_m": camera.min_depth_m,
    }
    if k.distortion:
        entry["distortion"] = list(k.distortion)
    if camera.max_depth_m < float("inf"):
        entry["max_depth_m"] = camera.max_depth_m
    if camera.noise is None:
        entry["noise"] = "exact"
    else:
        entry["noise"] = {
            name: getattr(camera.noise, name) for name in ("constant_m", "linear", "quadratic", "offset_m")
        }
    if camera.margin is not None:
        entry["margin"] = margin_entry(camera.margin)
    if camera.flying_pixels != (camera.noise is not None):
        entry["flying_pixels"] = camera.flying_pixels
    return dict(plain(entry))


def matrix_entry(matrix: NDArray[np.float64]) -> list[list[float]]:
    """A transform as a site file says it, row by row."""
    return [[round(float(v), DIGITS) + 0.0 for v in row] for row in matrix]


def margin_entry(margin: Margin) -> dict[str, float]:
    """A margin as a site file says it; to 7 digits after the point, rounded up."""
    names = ("sigmas", "bias_m", "lateral_px", "range_linear", "range_quadratic")
    return {name: math.ceil(getattr(margin, name) * 1e7 - 1e-6) / 1e7 for name in names}


def plain(value: Any) -> Any:
    """The same value in what YAML knows: NumPy's numbers as Python's."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [plain(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


def moved(value: Any, old: Path, new: Path) -> Any:
    """The same content with paths that lead from another folder to the same files.

    Args:
        value: a mapping, a list, or what stands in them.
        old, new: the folder that paths are relative to, and the one that they shall be relative to.
    """
    if isinstance(value, dict):
        return {
            key: led_from(item, old, new)
            if key in PATH_KEYS
            and isinstance(item, str)
            and not (key == "mesh" and SHIPPED_ROOM.fullmatch(item))
            # topics of a bag look like paths and are none
            else (item if key == "topics" else moved(item, old, new))
            for key, item in value.items()
        }
    return [moved(item, old, new) for item in value] if isinstance(value, list) else value
