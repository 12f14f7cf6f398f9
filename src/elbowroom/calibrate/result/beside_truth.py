"""What was found of a simulated capture, beside the truth that lies with it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.calibrate.result.change import pose_difference
from elbowroom.errors import InputError
from elbowroom.files.yaml_file import read_yaml

TRUTH_FILE = "truth.yaml"


def beside_truth(found: Sequence[CalibratedCamera], folder: Path) -> str | None:
    """How far the worst camera is from the truth, in words; None: there is none beside the site file.

    Args:
        found: the cameras.
        folder: of the site file.
    """
    path = folder / TRUTH_FILE
    if not path.is_file():
        return None
    try:
        true = read_yaml(path)["cameras"]
        off = {
            one.camera.name: pose_difference(
                one.camera.world_from_camera,
                np.array(true[one.camera.name]["world_from_camera"], dtype=float),
            )
            for one in found
        }
    except (InputError, KeyError, TypeError, ValueError, IndexError):
        return None  # some other file of that name
    worst, turned = (max(off, key=lambda name: off[name][axis]) for axis in (0, 1))
    return (
        f"cameras within {off[worst][0] * 1e3:.1f} mm ({worst}) and {np.degrees(off[turned][1]):.3f} degrees "
        f"({turned}) of {path.name}"
    )
