"""A recording as 16-bit images, a CSV of joints and the cameras: a recording of layout `folder`, and plain files."""

import csv
import json
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.errors import InputError
from elbowroom.files.atomic import folder, whole_file
from elbowroom.monitor.blackbox.recording import RecordedPass, Recording
from elbowroom.sources.recording_folder import Units

CAMERAS, JOINTS, SITE = "cameras.json", "joints.csv", "site_as_recorded.yaml"


class Export:
    """A folder that passes are written into.

    Args:
        recording: whose passes.
        place: the folder; made if it is not there, and then empty.
        unit_m: metres per unit of images that are not made of units.

    Raises:
        InputError: the folder holds something, or cannot be written to.
    """

    def __init__(self, recording: Recording, place: Path, unit_m: float) -> None:
        self.place, self.unit_m = place, unit_m
        self._recording, self._configuration = recording, recording.configuration()
        self._units: dict[str, float] = {}
        self._written: dict[str, set[int]] = {camera.name: set() for camera in self._configuration.cameras}
        self._joints: dict[int, dict[str, float]] = {}
        if place.is_dir() and any(place.iterdir()):
            raise InputError(f"{place}: holds files already; name another folder")
        for name in self._written:
            folder(place / name)

    def __enter__(self) -> Self:
        return self

    def add(self, one: RecordedPass) -> None:
        """Writes the frames of a pass that were not written yet.

        Raises:
            InputError: a file cannot be written.
        """
        snapshot = one.snapshot
        for frame in snapshot.frames:
            stamp_ns = frame.stamp_ns if frame.stamp_ns is not None else snapshot.now_ns or one.wall_ns
            if frame.camera not in self._written or stamp_ns in self._written[frame.camera]:
                continue
            self._write(self.place / frame.camera / f"{stamp_ns}.png", self._numbers(one, frame.camera))
            self._written[frame.camera].add(stamp_ns)
            joints = snapshot.joints_at(frame.camera)
            if joints is not None:
                self._joints[stamp_ns] = dict(joints)

    def rows(self) -> list[dict[str, Any]]:
        """By camera: how many images, in which unit."""
        return [
            {"camera": name, "images": len(stamps), "unit_m": self._units.get(name, self.unit_m)}
            for name, stamps in self._written.items()
        ]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            return
        with whole_file(self.place / SITE) as path:
            path.write_bytes(self._configuration.site_text)
        with whole_file(self.place / CAMERAS) as path:
            path.write_text(json.dumps([self._camera(c) for c in self._configuration.cameras], indent=1))
        if self._joints:
            with whole_file(self.place / JOINTS) as path, path.open("w", newline="") as file:
                names = list(next(iter(self._joints.values())))
                writer = csv.writer(file)
                writer.writerow(["stamp_ns", *names])
                for stamp_ns in sorted(self._joints):
                    writer.writerow([stamp_ns, *(repr(self._joints[stamp_ns][name]) for name in names)])

    def _numbers(self, one: RecordedPass, camera: str) -> NDArray[np.uint16]:
        """The sensor's whole numbers, or depth in units, rounded down."""
        found = self._recording.units_of(camera)
        if found is not None:
            self._units[camera] = found[1]
            return found[0]
        frame = next(frame for frame in one.snapshot.frames if frame.camera == camera)
        return Units(self.unit_m).of(frame.depth_m)

    def _write(self, path: Path, pixels: NDArray[np.uint16]) -> None:
        try:
            Image.fromarray(pixels).save(path, format="PNG", compress_level=1)
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror})") from None

    def _camera(self, camera: Any) -> dict[str, Any]:
        of = camera.intrinsics
        return {
            "name": camera.name,
            "width": camera.width,
            "height": camera.height,
            "fx": of.fx,
            "fy": of.fy,
            "cx": of.cx,
            "cy": of.cy,
            "distortion": list(of.distortion),
            "depth_kind": camera.depth_kind,
            "metres_per_unit": self._units.get(camera.name, self.unit_m),
            "world_from_camera": camera.world_from_camera.tolist(),
        }
