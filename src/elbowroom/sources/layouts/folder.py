"""Layout `folder`: `<camera>/<stamp_ns>.png`, and a CSV of joints; what lies near in time makes a moment."""

from bisect import bisect_left
from dataclasses import dataclass
from pathlib import Path

from elbowroom.errors import FrameError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import JointRecord
from elbowroom.site.paths import inside
from elbowroom.site.recording_entry import StampedFolder
from elbowroom.site.site import Site
from elbowroom.sources.layouts.image import Image


@dataclass(frozen=True, slots=True, eq=False)
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
            SiteError: images of an unknown camera, or none at all.
            FrameError: two images of a camera at one time, or a name that is no time.
        """
        series = list(self.by_camera().values())
        leader = max(series, key=len)
        if not leader:
            raise SiteError(
                f"{self.site.path}: recording: no frames; expected {self.folder}/<camera>/<stamp_ns>.png"
            )
        skew_ns = round(self.recording.max_skew_ms * 1e6)
        groups = []
        for lead in leader:
            near = [_nearest(row, lead.stamp_ns or 0, skew_ns) for row in series]
            groups.append([image for image in near if image is not None])
        return groups

    def by_camera(self) -> dict[str, list[Image]]:
        """Each camera's images by rising time; none if it has no folder. Raises as `moments`."""
        cameras = self.site.cameras()
        self._refuse_unknown({camera.name for camera in cameras})
        return {camera.name: self._images_of(camera) for camera in cameras}

    def joints(self) -> JointRecord | None:
        """The joints of `joints_file`; None: there is no such file, and no machine that needs it.

        Raises:
            SiteError: the file is not usable, or missing where there is a machine.
        """
        path = self.folder / inside(self.folder, self.recording.joints_file)
        if not path.exists() and self.site.entry.machine is None:
            return None
        return JointRecord.from_csv(path, max_gap_ns=round(self.recording.max_joint_gap_ms * 1e6))

    def _refuse_unknown(self, known: set[str]) -> None:
        for path in sorted(self.folder.iterdir()):
            if (
                path.is_dir()
                and path.name not in known
                and path.name not in self.recording.ignore
                and any(path.glob("*.png"))
            ):
                raise SiteError(
                    f"{path}: images of an unknown camera; cameras are {', '.join(sorted(known))}, "
                    "others are named in recording.ignore"
                )

    def _images_of(self, camera: DepthCamera) -> list[Image]:
        images: dict[int, Image] = {}
        for path in sorted((self.folder / camera.name).glob("*.png")):
            if not (path.stem.isdecimal() and path.stem.isascii() and len(path.stem) <= 19):
                raise FrameError(
                    f"{path}: name must be the time of exposure in whole nanoseconds, <stamp_ns>.png"
                )
            stamp = int(path.stem)
            if stamp in images:
                raise FrameError(
                    f"{path}: two frames of camera {camera.name} at {stamp} ns, "
                    f"the other is {images[stamp].path.name}"
                )
            images[stamp] = Image.of(self.site, camera, stamp, path)
        return [images[stamp] for stamp in sorted(images)]


def _nearest(row: list[Image], stamp_ns: int, within_ns: int) -> Image | None:
    stamps = [image.stamp_ns or 0 for image in row]
    after = bisect_left(stamps, stamp_ns)
    # the earlier of two that are equally near
    near = min(
        row[max(after - 1, 0) : after + 1],
        key=lambda image: abs((image.stamp_ns or 0) - stamp_ns),
        default=None,
    )
    return near if near is not None and abs((near.stamp_ns or 0) - stamp_ns) <= within_ns else None
