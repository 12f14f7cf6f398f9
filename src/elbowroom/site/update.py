"""A site file with cameras that were calibrated, written beside the old one."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.site import Site
from elbowroom.site.camera_entry import PINHOLE
from elbowroom.site.recording_entry import SevenScenes
from elbowroom.site.schema import SIMULATED_SETTINGS
from elbowroom.site.written import (
    camera_entry,
    margin_entry,
    matrix_entry,
    plain,
    refuse_own_file,
    said_again,
    written,
)

POSE_KEYS = (
    "world_from_camera", "pose_file", "position_m", "look_at_m", "up", "quaternion_xyzw", "quaternion_wxyz",
    "pose_covariance",
)  # fmt: skip
LENS_KEYS = ("intrinsics_file", *PINHOLE, "distortion")
SIGNATURE = "calibrated by `elbowroom calibrate"
"""In the first line of each file that is written here: such a file may be written again."""


def update_site(
    site: Site,
    cameras: Sequence[DepthCamera],
    covariances: Mapping[str, NDArray[np.float64]],
    path: Path,
    command: str,
    world_from_base: NDArray[np.float64] | None = None,
) -> Path:
    """Writes the site again with what was found of its cameras; all that it says otherwise stays.

    Of each camera only pose, covariance, margin and, if they changed, intrinsics are replaced. Cameras that are not
    given stay as they are. Paths are written so that they lead to the same files from the new place. Comments stay.

    Args:
        site: the old one.
        cameras: those that were calibrated, with their new margins.
        covariances: of their poses by name, shape (6, 6); see `CameraEntry`.
        path: the file to write; there must be none of that name but one that was written here.
        command: what found them, as typed after `elbowroom calibrate`.
        world_from_base: where the machine was found to stand, shape (4, 4); None: it stays as it is.

    Returns:
        The path.

    Raises:
        SiteError: there is another file of that name, a camera that the site does not have, or poses that come from
            the recording.
        InputError: the folder cannot be written to.
    """
    refuse_other_files(site, path)
    if isinstance(site.entry.recording, SevenScenes):
        raise SiteError(f"{site.path}: poses come with the recording (layout seven_scenes); nothing to write")
    content = said_again(site, path)
    if world_from_base is not None and site.entry.machine is None:
        raise SiteError(
            f"{site.path}: several machines; write world_from_base of the one that was seen by hand"
        )
    if site.lists_cameras:
        content["cameras"] = _replaced(site, content["cameras"], cameras, covariances)
    else:
        shared = content.pop("camera_defaults", {})
        kept = {key: value for key, value in shared.items() if key not in SIMULATED_SETTINGS}
        content |= {"camera_defaults": kept} if kept else {}
        content["cameras"] = [
            camera_entry(camera) | _found(site, camera, covariances, known=False) for camera in cameras
        ]
    if world_from_base is not None:
        content["machine"]["world_from_base"] = matrix_entry(world_from_base)
    return written(content, path, f"{site.name}: {SIGNATURE} {command}`", site)


def update_lenses(site: Site, lenses: Mapping[str, Mapping[str, Any]], path: Path, command: str) -> Path:
    """Writes the site again with other intrinsics, depth scales and biases; poses and all else stay.

    Args:
        site: the old one, which lists its cameras.
        lenses: keys of `CameraSettings` that are replaced, by camera; `intrinsics_file` goes where they are given.
        path: the file to write; there must be none of that name but one that was written here.
        command: what found them, as typed after `elbowroom calibrate`.

    Raises:
        SiteError: there is another file of that name, or the site lists no cameras.
        InputError: the folder cannot be written to.
    """
    refuse_other_files(site, path)
    if not site.lists_cameras:
        raise SiteError(f"{site.path}: cameras: the site lists none, so there is nothing to write")
    content = said_again(site, path)
    for entry in content["cameras"]:
        found = lenses.get(entry["name"])
        if found is not None:
            for key in LENS_KEYS:
                entry.pop(key, None)
            entry.update(plain(dict(found)))
    return written(content, path, f"{site.name}: {SIGNATURE} {command}`", site)


def refuse_other_files(site: Site, path: Path) -> None:
    """Only a new file, or one that was written here, and never the site's own.

    Raises:
        SiteError: another file.
    """
    if not path.exists():
        return
    refuse_own_file(site, path)
    if not path.is_file():
        raise SiteError(f"{path}: is no file; name another")
    with path.open(encoding="utf-8", errors="replace") as file:
        if SIGNATURE not in file.readline(1000):
            raise SiteError(
                f"{path}: is there already, and was not written by a calibration; name another file"
            )


def _replaced(
    site: Site,
    entries: Sequence[dict[str, Any]],
    cameras: Sequence[DepthCamera],
    covariances: Mapping[str, NDArray[np.float64]],
) -> list[dict[str, Any]]:
    found = {camera.name: camera for camera in cameras}
    unknown = sorted(set(found) - {entry["name"] for entry in entries})
    if unknown:
        raise SiteError(f"{site.path}: cameras: there is no {', '.join(unknown)}")
    old = {camera.name: camera.intrinsics for camera in site.cameras()}
    result = []
    for entry in entries:
        camera = found.get(entry["name"])
        if camera is None:
            result.append(entry)
            continue
        dropped = POSE_KEYS if _same(camera.intrinsics, old[camera.name]) else (*POSE_KEYS, *LENS_KEYS)
        kept = {key: value for key, value in entry.items() if key not in dropped}
        lens = {} if dropped is POSE_KEYS else lens_entry(camera.intrinsics)
        result.append(kept | lens | _found(site, camera, covariances, known=True))
    return result


def _found(
    site: Site, camera: DepthCamera, covariances: Mapping[str, NDArray[np.float64]], *, known: bool
) -> dict[str, Any]:
    entry: dict[str, Any] = {"world_from_camera": matrix_entry(camera.world_from_camera)}
    if camera.margin is not None:
        entry["margin"] = margin_entry(camera.margin)
        entry["sensor_margin"] = margin_entry(site.sensor_margin(camera.name) if known else site.margin())
    if camera.name in covariances:
        entry["pose_covariance"] = [
            [float(f"{value:.6g}") for value in row] for row in covariances[camera.name]
        ]
    return dict(plain(entry))


def lens_entry(intrinsics: Intrinsics) -> dict[str, Any]:
    """Intrinsics as a site file says them; without distortion an empty list, which overrules a shared one."""
    entry = {key: float(getattr(intrinsics, key)) for key in PINHOLE}
    return {**entry, "distortion": list(intrinsics.distortion)}


def _same(one: Intrinsics, other: Intrinsics) -> bool:
    return all(getattr(one, key) == getattr(other, key) for key in (*PINHOLE, "distortion"))
