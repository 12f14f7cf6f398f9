"""A site file with the cameras of a layout, which `elbowroom monitor` runs."""

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.files.atomic import whole_file
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import Margin
from elbowroom.site import Site
from elbowroom.site.paths import expand
from elbowroom.site.schema import EVEN_SETTINGS

PATH_KEYS = ("intrinsics_file", "pose_file", "urdf", "mesh", "folder")
"""Keys whose values are paths beside the site file."""
DIGITS = 9


def write_site(site: Site, cameras: Sequence[DepthCamera], path: Path) -> Path:
    """Writes the site again with these cameras in place of its own.

    All that the site says otherwise stays; paths are written so that they lead to the same files from the new place.
    Comments are lost. Cameras stand with all that they are, so that nothing depends on `camera_defaults` any more.

    Args:
        site: what is taken over.
        cameras: all of the layout.
        path: the file to write; there must be none of that name but one that was written by the same means.

    Returns:
        The path.

    Raises:
        SiteError: the new file would be the site's own.
        InputError: the folder cannot be written to.
    """
    if path.exists() and path.samefile(site.path):
        raise SiteError(f"{path}: is the site file itself; write the layout beside it, under another name")
    content = site.entry.model_dump(mode="json", exclude_unset=True, exclude={"cameras"})
    if site.simulated is not None:
        content["simulated"] = {k: v for k, v in content["simulated"].items() if k not in EVEN_SETTINGS}
    content = moved(content, site.path.parent, path.absolute().parent)
    content["cameras"] = [camera_entry(camera) for camera in cameras]
    if site.simulated is not None:
        content.pop("camera_defaults", None)
    text = f"# {site.name}: {len(cameras)} cameras, placed by `elbowroom placement optimise`\n"
    text += yaml.safe_dump(content, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")
    Site.load(path).cameras()
    return path


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
    """The same content with paths that lead from another folder to the same files."""
    if isinstance(value, dict):
        return {
            key: os.path.relpath(expand(item, old.absolute()), new)
            if key in PATH_KEYS and isinstance(item, str)
            else moved(item, old, new)
            for key, item in value.items()
        }
    return [moved(item, old, new) for item in value] if isinstance(value, list) else value
