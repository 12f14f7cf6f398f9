"""A folder of images of layout `folder`, written moment by moment, that is whole or not there."""

import csv
import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from elbowroom.errors import InputError
from elbowroom.files.atomic import folder
from elbowroom.sensing import DepthFrame

LARGEST = 65534
"""65535 is no return."""
MARK = "simulated.json"
"""Says of a folder that a simulator wrote it, so that it may be written again."""
JOINTS = "joints.csv"


@dataclass(frozen=True, slots=True)
class Units:
    """How a camera's depth is counted on disk.

    Args:
        scale_m: metres per unit.
        bias_m: is added to each depth when it is read [m].
    """

    scale_m: float
    bias_m: float = 0.0

    def of(self, depth_m: NDArray[np.floating]) -> NDArray[np.uint16]:
        """Depth in whole units, rounded down, shape (height, width); 0 where there is no return or it is too far."""
        has_return = np.isfinite(depth_m) & (depth_m > 0)
        units = np.floor(np.where(has_return, depth_m - self.bias_m, 0.0) / self.scale_m + 1e-6)
        return np.where((units > 0) & (units <= LARGEST), units, 0).astype(np.uint16)


class RecordingFolder:
    """Writes `<camera>/<stamp_ns>.png` and `joints.csv` beside their place, and puts them there at its end.

    Depth is rounded down: what is read back is never farther than what was rendered. What was there before is replaced
    as a whole, if a simulator wrote it, so that no image of another run stays. A moment that was left in the middle is
    left out. Where the block fails, or without a moment, all stays as it was.

    Args:
        place: the folder.
        units: by camera, how its depth is counted.

    Raises:
        InputError: the folder cannot be made, or holds files that no simulator wrote.
    """

    def __init__(self, place: Path, units: Mapping[str, Units]) -> None:
        self.place, self.units = place, dict(units)
        self._stamps: list[int] = []
        self._rows: list[tuple[int, dict[str, float]]] = []
        refuse_foreign(place)
        self._unfinished = place.with_name(f".{place.name}.unfinished")

    def __enter__(self) -> Self:
        shutil.rmtree(self._unfinished, ignore_errors=True)
        for name in self.units:
            folder(self._unfinished / name)
        return self

    @property
    def moments(self) -> int:
        """How many are whole."""
        return len(self._stamps)

    def add(self, frames: Sequence[DepthFrame], joints: Mapping[str, float] | None) -> None:
        """Writes a moment.

        Args:
            frames: one of each camera, all of one time.
            joints: positions by name [m or rad]; None: there is no machine.
        """
        written = []
        for frame in frames:
            path = self._unfinished / frame.camera / f"{frame.stamp_ns}.png"
            written.append((path.with_suffix(".part"), path))
            pixels = self.units[frame.camera].of(frame.depth_m)
            Image.fromarray(pixels).save(written[-1][0], format="PNG", compress_level=6)
        for part, path in written:
            part.replace(path)
        stamp_ns = frames[0].stamp_ns or 0
        if joints is not None:
            self._rows.append((stamp_ns, dict(joints)))
        self._stamps.append(stamp_ns)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None and self._stamps:
                self._put()
        finally:
            shutil.rmtree(self._unfinished, ignore_errors=True)

    def _put(self) -> None:
        for path in self._unfinished.glob("*/*"):
            if path.suffix != ".png" or int(path.stem) not in self._stamps:
                path.unlink()  # of a moment that was left in the middle
        if self._rows:
            with (self._unfinished / JOINTS).open("w", newline="") as file:
                writer = csv.writer(file)
                writer.writerow(["stamp_ns", *self._rows[0][1]])
                for stamp_ns, joints in self._rows:
                    writer.writerow([stamp_ns, *(repr(float(value)) for value in joints.values())])
        mark = {"written_by": "elbowroom simulate", "moments": self.moments, "cameras": list(self.units)}
        (self._unfinished / MARK).write_text(json.dumps(mark) + "\n", encoding="utf-8")
        if self.place.exists():
            shutil.rmtree(self.place)
        folder(self.place.parent)
        self._unfinished.rename(self.place)


def refuse_foreign(place: Path) -> None:
    """Makes sure that a folder may be written anew: it is not there, is empty, or holds what a simulator wrote.

    Raises:
        InputError: it holds something else, or is a file.
    """
    if place.is_file():
        raise InputError(f"{place}: is a file; name a folder")
    if not place.is_dir() or not any(place.iterdir()) or _is_simulated(place):
        return
    raise InputError(
        f"{place}: holds files that `elbowroom simulate` did not write, and which it would replace; "
        "name another folder, or move them away"
    )


def _is_simulated(place: Path) -> bool:
    """Whether a folder holds the images that its mark says, and nothing else."""
    try:
        mark = json.loads((place / MARK).read_text(encoding="utf-8"))
        expected = mark["moments"] * len(mark["cameras"])
    except (OSError, ValueError, KeyError, TypeError):
        return False
    files = [path for path in place.rglob("*") if path.is_file()]
    images = [path for path in files if path.suffix == ".png" and path.parent.name in mark["cameras"]]
    return len(images) == expected and {path.name for path in files if path not in images} <= {MARK, JOINTS}
