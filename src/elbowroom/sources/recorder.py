"""Moments of a simulated room written as a recording: images, joints, and a site file that reads them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.files.atomic import folder
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.sensing import DepthFrame
from elbowroom.site import Site
from elbowroom.site.written import written
from elbowroom.sources.recording_folder import LARGEST, RecordingFolder, Units

UNIT_M = 0.0002
"""Metres per unit of the images: 65534 of them reach 13 m."""


@dataclass(frozen=True, slots=True)
class Recording:
    """What a recording's site file says besides cameras and images.

    Args:
        name: of the room.
        grid: the watched box.
        joints: of the ceiling C-arm, by name [m or rad]; None: there is no machine.
        noise: name of the sensors' noise, such as "tof"; "exact": none.
    """

    name: str
    grid: VoxelGrid
    joints: dict[str, float] | None
    noise: str


def write_recording(
    out: Path, what: Recording, cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame]
) -> Path:
    """Writes `images/<camera>/<stamp_ns>.png`, `images/joints.csv` and `site.yaml`.

    Depth is rounded down to units of 0.2 mm: what is read back is never farther than what was rendered.

    Args:
        out: folder, made if it is not there.
        what: the rest of the site file.
        cameras: in the order of the frames.
        frames: one of each camera.

    Returns:
        The site file.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    units = {camera.name: Units(UNIT_M) for camera in cameras}
    with RecordingFolder(folder(out) / "images", units) as recording:
        recording.add(frames, what.joints)
    return write_site_of(out, what, cameras)


def write_site_of(out: Path, what: Recording, cameras: Sequence[DepthCamera]) -> Path:
    """Writes `site.yaml`, which reads the images beside it.

    Args:
        out: the folder that holds `images`.
        what: the rest of the site file.
        cameras: of the images.

    Returns:
        The site file.
    """
    return written(_site(what, cameras), out / "site.yaml", "written by elbowroom simulate")


def as_units(depth_m: NDArray[np.floating]) -> NDArray[np.uint16]:
    """Depth in whole units, rounded down, shape (height, width); 0 where there is no return or it is too far."""
    return Units(UNIT_M).of(depth_m)


def recorded_site(name: str, grid: VoxelGrid, cameras: Sequence[DepthCamera], noise: str) -> dict[str, Any]:
    """What a site file says of cameras of one kind, and of their images beside it.

    Args:
        name: of the site.
        grid: the watched box.
        cameras: alike but for name and pose.
        noise: name of the sensors' noise, such as "tof"; "exact": none.
    """
    first = cameras[0]
    return {
        "name": name,
        "grid": {
            "origin_m": grid.lower_m.tolist(),
            "shape": list(grid.shape),
            "voxel_size_m": grid.voxel_size_m,
        },
        "camera_defaults": {
            "width": first.width,
            "height": first.height,
            **{name: float(getattr(first.intrinsics, name)) for name in ("fx", "fy", "cx", "cy")},
            "depth_kind": first.depth_kind,
            "depth_scale_m": UNIT_M,
            "noise": noise,
            **({"repeats": True} if noise == "exact" else {}),
            "min_depth_m": first.min_depth_m,
            "max_depth_m": min(first.max_depth_m, LARGEST * UNIT_M),
        },
        "cameras": [
            {"name": camera.name, "world_from_camera": camera.world_from_camera.tolist()}
            for camera in cameras
        ],
        "recording": {"layout": "folder", "folder": "images"},
    }


def _site(what: Recording, cameras: Sequence[DepthCamera]) -> dict[str, Any]:
    machine = {} if what.joints is None else {"machine": {"builtin": "ceiling_c_arm"}, "joints": _speeds()}
    return {
        **recorded_site(what.name, what.grid, cameras, what.noise),
        **machine,
        "rule": "three",
        "detail": "pixel",
        "margin": {"sigmas": 3.0, "bias_m": 0.0, "lateral_px": 0.5},
    }


def _speeds() -> dict[str, Any]:
    """Of the ceiling C-arm, as the site file of the simulated room has them."""
    entries = Site.simulated_room().entry.joints
    return {name: entry.model_dump(exclude_none=True) for name, entry in entries.items()}
