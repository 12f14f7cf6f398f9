"""Layout `folder`: `<camera>/<stamp_ns>.png` or `.pgm`, and a CSV of joints; what lies near in time makes a moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from elbowroom.errors import FrameError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import JointRecord
from elbowroom.site.paths import inside
from elbowroom.site.recording_entry import StampedFolder, StampUnit
from elbowroom.site.site import Site
from elbowroom.sources.depth_image import images_in, is_hidden, others_text
from elbowroom.sources.layouts.gathered import gathered, series_of
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.times.company import require_dates
from elbowroom.sources.times.joints import of_machine, require_meeting
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.stamp import require_padded, require_possible, stamp_of, unit_of


@dataclass(frozen=True, eq=False)
class Folder:
    """A recording of this layout (`Layout`).

    Args:
        site: that names it.
        recording: what the site says of it.
        folder: where it lies.
    """

    site: Site
    recording: StampedFolder
    folder: Path

    def moments(self) -> list[list[Image]]:
        """Images gathered around those of the camera that has most: of each other the nearest, within `max_skew_ms`.

        Raises:
            SiteError: images of an unknown camera, none at all, or steps that no camera makes.
            FrameError: two images of a camera at one time, or a name that is no time.
        """
        meeting = self.meeting
        require_dates(self.site.path, meeting)
        return gathered(self._rows, meeting)

    @cached_property
    def meeting(self) -> Meeting:
        """When each camera's images were taken, and who meets whom; raises as `moments`."""
        series = series_of(self._rows)
        if not any(map(len, series)):
            raise SiteError(
                f"{self.site.path}: recording: no frames; expected {self.folder}/<camera>/<stamp_ns>.png, or .pgm"
                f"{others_text(self.folder)}"
            )
        declared = self.recording.stamp_unit is not None
        return Meeting(series, round(self.recording.max_skew_ms * 1e6), declared)

    def by_camera(self) -> dict[str, list[Image]]:
        """Each camera's images by rising time; none if it has no folder. Raises as `moments`."""
        return dict(self._rows)

    @property
    def joints_path(self) -> Path:
        """Of the CSV of joints."""
        return self.folder / inside(self.folder, self.recording.joints_file)

    @cached_property
    def _rows(self) -> dict[str, list[Image]]:
        cameras = self.site.cameras()
        self._refuse_unknown({camera.name for camera in cameras})
        paths = {camera.name: images_in(self.folder / camera.name) for camera in cameras}
        declared = self.recording.stamp_unit
        for row in paths.values():
            require_padded(row)
        unit = unit_of([path for row in paths.values() for path in row], declared)
        rows = {camera.name: self._images_of(camera, paths[camera.name], unit) for camera in cameras}
        stamps = {name: [image.stamp_ns or 0 for image in row] for name, row in rows.items()}
        require_possible(self.site.path, stamps, unit, declared is not None)
        return rows

    def joints(self) -> JointRecord | None:
        """The joints of `joints_file`; None: there is no such file, and no machine that was there.

        Raises:
            JointsError: the file is not usable, missing where there is a machine, or not of this machine.
        """
        path, machine = self.joints_path, self.site.machine()
        if not path.exists() and (machine is None or self.recording.without_machine):
            return None
        record = JointRecord.from_csv(path, max_gap_ns=round(self.recording.max_joint_gap_ms * 1e6))
        if machine is None:
            return record
        require_meeting(path, record, self.meeting)
        return of_machine(self.site, machine, path, record)

    def _refuse_unknown(self, known: set[str]) -> None:
        for path in sorted(self.folder.iterdir()):
            if (
                path.is_dir()
                and not is_hidden(path)
                and path.name not in known
                and path.name not in self.recording.ignore
                and images_in(path)
            ):
                raise SiteError(
                    f"{path}: images of an unknown camera; cameras are {', '.join(sorted(known))}, "
                    "others are named in recording.ignore"
                )

    def _images_of(self, camera: DepthCamera, paths: Sequence[Path], unit: StampUnit) -> list[Image]:
        images: dict[int, Image] = {}
        for path in paths:
            stamp = stamp_of(path, unit)
            if stamp in images:
                raise FrameError(
                    f"{path}: two frames of camera {camera.name} at {stamp} ns, "
                    f"the other is {images[stamp].path.name}"
                )
            images[stamp] = Image.of(self.site, camera, stamp, path)
        return [images[stamp] for stamp in sorted(images)]
