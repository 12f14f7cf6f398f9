"""A simulated capture on disk: images, site file, and the truth for evaluation alone."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from elbowroom.calibrate.simulated.start import TrueCamera
from elbowroom.errors import CalibrationError
from elbowroom.files.atomic import folder, whole_file
from elbowroom.files.yaml_file import read_yaml
from elbowroom.geometry import VoxelGrid
from elbowroom.sources.recorder import LARGEST, UNIT_M, as_units

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
        """Writes a depth image in units of 0.2 mm [m, shape (h, w)], with the camera's scale and bias."""
        measured = np.where(depth_m > 0, depth_m * camera.depth_scale + camera.depth_bias_m, 0.0)
        path = self.out / "images" / camera.true.name / f"{stamp_ns}.png"
        _save(path, as_units(measured + UNIT_M / 2))

    def infrared(self, camera: TrueCamera, stamp_ns: int, grey: NDArray[np.uint8]) -> None:
        """Writes an infrared image, shape (h, w)."""
        _save(folder(self.out / INFRARED_FOLDER / camera.true.name) / f"{stamp_ns}.png", grey)

    def site(self, noise: str, more: Mapping[str, Any], grid: VoxelGrid) -> Path:
        """Writes the site file, with what is said of the cameras, and gives its path.

        Args:
            noise: name of the sensors' noise.
            more: further keys.
            grid: the watched box.
        """
        first = self.cameras[0].said
        content = {
            "name": "capture for calibration",
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
                "min_depth_m": first.min_depth_m,
                "max_depth_m": min(first.max_depth_m, LARGEST * UNIT_M),
            },
            "cameras": [
                {"name": camera.said.name, "world_from_camera": camera.said.world_from_camera.tolist()}
                for camera in self.cameras
            ],
            "recording": {"layout": "folder", "folder": "images"},
            **more,
        }
        path = self.out / "site.yaml"
        _write_yaml(
            path, "# written by elbowroom calibrate simulate; poses are as rough as was asked for\n", content
        )
        return path

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
        path = self.out / TRUTH_FILE
        _write_yaml(path, "# the truth behind a simulated capture: for evaluation alone\n", content)
        return path


def read_truth(folder_of_capture: Path) -> dict[str, Any]:
    """What `CaptureWriter.truth` wrote.

    Raises:
        SiteError: there is none.
    """
    return read_yaml(folder_of_capture / TRUTH_FILE)


def _save(path: Path, pixels: NDArray[Any]) -> None:
    with whole_file(path) as unfinished:
        Image.fromarray(pixels).save(unfinished, format="PNG", compress_level=1)


def _write_yaml(path: Path, head: str, content: Mapping[str, Any]) -> None:
    with whole_file(path) as unfinished:
        unfinished.write_text(
            head + yaml.safe_dump(dict(content), sort_keys=False, default_flow_style=None, width=110),
            encoding="utf-8",
        )
