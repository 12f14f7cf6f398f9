"""The layout of 7-Scenes and TSDF-fusion: a depth PNG and a pose text per frame, one camera matrix.

Names as in the data set "7-Scenes" (Shotton et al. and Glocker et al. 2013) and in Zeng's tsdf-fusion:
`frame-000000.depth.png` in millimetres, 0 and 65535 without return; `frame-000000.pose.txt`, 4x4, camera to
world, metres.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.files.matrix_file import read_matrix
from elbowroom.site.recording_entry import SevenScenes

INTRINSICS_FILE = "camera-intrinsics.txt"
_DEPTH_NAME = re.compile(r"frame-(\d{6})\.depth\.png")


def name_of(frame: int) -> str:
    """Name of the camera that a frame is."""
    return f"frame-{frame:06d}"


def pose(folder: Path, frame: int) -> NDArray[np.float64]:
    """world_from_camera as the file says it, shape (4, 4).

    Raises:
        SiteError: missing or unusable.
    """
    return read_matrix(folder / f"{name_of(frame)}.pose.txt", (4, 4), "pose, camera to world")


def chosen(folder: Path, recording: SevenScenes) -> tuple[int, ...]:
    """Numbers of the frames that a recording includes and does not exclude, rising.

    Raises:
        SiteError: the folder has no frames, or a frame that is named is not there.
    """
    found = {int(match[1]) for path in folder.iterdir() if (match := _DEPTH_NAME.fullmatch(path.name))}
    if not found:
        raise SiteError(f"{folder}: no frames; expected frame-000000.depth.png and the like")
    wanted = found if recording.include is None else set(recording.include)
    absent = sorted((wanted | set(recording.exclude)) - found)
    if absent:
        raise SiteError(
            f"{folder}: frame {absent[0]} is not there; it has {len(found)} from {min(found)} to {max(found)}"
        )
    left = tuple(sorted(wanted - set(recording.exclude)))
    if not left:
        raise SiteError(f"{folder}: all {len(wanted)} frames are excluded; at least one must be left")
    return left
