"""A simulated capture on disk: images, site file, and the truth for evaluation alone."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.calibrate.simulated.start import TrueCamera
from elbowroom.errors import CalibrationError
from elbowroom.files.atomic import folder, whole_file
from elbowroom.files.yaml_file import read_yaml, write_yaml
from elbowroom.geometry import VoxelGrid
from elbowroom.site.written import written
from elbowroom.sources.recorder import UNIT_M, as_units, recorded_site

INFRARED_FOLDER = "infrared"
TRUTH_FILE = "truth.yaml"


class CaptureWriter:
    """Writes `images/<camera>/<stamp_ns>.png`, `infrared/<camera>/<stamp_ns>.png`, `site.yaml` and `truth.yaml`.

    Args:
        out: folder, made if it is not there.
        cameras: true and said.

    Raises:
        InputError: the folder cannot be made, or holds images already.
    """

    def __init__(self, out: Path, cameras: Sequence[TrueCamera]) -> None:
        self.out, self.cameras = folder(out), tuple(cameras)
        if any((self.out / "images").glob("*/*.png")):
            raise CalibrationError(f"{out}: holds images already; name another folder, or empty this one")
        for camera in self.cameras:
            folder(self.out / "images" / camera.true.name)

    def depth(self, camera: TrueCamera, stamp_ns: int, depth_m: NDArray[np.floating]) -> None:
        """Writes a depth image in units of 0.2 mm [m, shape (h, w)], with the camera's scale and bias.

        Args:
            camera: that delivers it.
            stamp_ns: time of exposure [ns].
            depth_m: true depth, shape (h, w) [m].
        """
        measured = np.where(depth_m > 0, depth_m * camera.depth_scale + camera.depth_bias_m, 0.0)
        path = self.out / "images" / camera.true.name / f"{stamp_ns}.png"
        _save(path, as_units(measured + UNIT_M / 2))

    def infrared(self, camera: TrueCamera, stamp_ns: int, grey: NDArray[np.uint8]) -> None:
        """Writes an infrared image, shape (h, w).

        Args:
            camera: that delivers it.
            stamp_ns: time of exposure [ns].
            grey: shape (h, w).
        """
        _save(folder(self.out / INFRARED_FOLDER / camera.true.name) / f"{stamp_ns}.png", grey)

    def site(self, noise: str, more: Mapping[str, Any], grid: VoxelGrid) -> Path:
        """Writes the site file, with what is said of the cameras, and gives its path.

        Args:
            noise: name of the sensors' noise.
            more: further keys.
            grid: the watched box.
        """
        cameras = [camera.said for camera in self.cameras]
        content = recorded_site("capture for calibration", grid, cameras, noise) | dict(more)
        by = "written by elbowroom calibrate simulate; poses are as rough as was asked for"
        return written(content, self.out / "site.yaml", by)

    def truth(self, more: Mapping[str, Any]) -> Path:
        """Writes what is true of the cameras, and further keys; no command but an evaluation reads it."""
        content = {
            "cameras": {
                camera.true.name: {
                    "world_from_camera": camera.true.world_from_camera.tolist(),
                    **{
                        name: float(getattr(camera.true.intrinsics, name))
                        for name in ("fx", "fy", "cx", "cy")
                    },
                    "distortion": list(camera.true.intrinsics.distortion),
                    "depth_scale": float(camera.depth_scale),
                    "depth_bias_m": float(camera.depth_bias_m),
                }
                for camera in self.cameras
            },
            **more,
        }
        head = "the truth behind a simulated capture: for evaluation alone"
        return write_yaml(self.out / TRUTH_FILE, content, head)


def read_truth(folder_of_capture: Path) -> dict[str, Any]:
    """What `CaptureWriter.truth` wrote.

    Raises:
        SiteError: there is none.
    """
    return read_yaml(folder_of_capture / TRUTH_FILE)


def _save(path: Path, pixels: NDArray[Any]) -> None:
    with whole_file(path) as unfinished:
        Image.fromarray(pixels).save(unfinished, format="PNG", compress_level=1)
