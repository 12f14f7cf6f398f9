"""Recorded frames of all cameras, moment by moment."""

from bisect import bisect_left
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from elbowroom.errors import FrameError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame, JointRecord
from elbowroom.site.depth_png import check_depth_png, read_depth_png
from elbowroom.site.paths import inside
from elbowroom.site.recording_entry import SevenScenes, StampedFolder, StamplessFolder
from elbowroom.site.site import Site

Positions = Mapping[str, float]
"""Joint positions by name [m or rad]."""


class Image(NamedTuple):
    """An image on disk that has not been read."""

    camera: DepthCamera
    stamp_ns: int | None
    path: Path
    scale_m: float

    def read(self) -> DepthFrame:
        """The frame.

        Raises:
            FrameError: the file is not what its camera delivers.
        """
        raw = read_depth_png(self.path, self.camera.width, self.camera.height)
        return DepthFrame.from_raw(self.camera.name, self.stamp_ns, raw, scale_m=self.scale_m)

    def check(self) -> None:
        """Looks at the file's header alone; raises FrameError as `read` would."""
        check_depth_png(self.path, self.camera.width, self.camera.height)


@dataclass(frozen=True, slots=True, eq=False)
class RecordedMoment:
    """Frames of one moment, at most one per camera, and where the machine was.

    Args:
        stamp_ns: the latest time of exposure among the frames [ns]; None: they have no times.
        frames: in the order of the site's cameras; a camera without a frame near this moment is left out.
        joints: joint positions at the moment, by name [m or rad]; None: not known.
        joints_of: joint positions at each frame's own time, by camera.
    """

    stamp_ns: int | None
    frames: tuple[DepthFrame, ...]
    joints: Positions | None = None
    joints_of: Mapping[str, Positions] = field(default_factory=dict)


def moments(site: Site, joints: Positions | JointRecord | None = None) -> Iterator[RecordedMoment]:
    """The moments of a site's recording, in order; images are read one moment at a time.

    Frames of layout `folder` gather around those of the camera that has most: per other camera the nearest in
    time, within `max_skew_ms`.

    Args:
        site: with a recording.
        joints: positions that hold throughout, or a record; None: the recording's own, if it has any.

    Raises:
        SiteError: no recording, its folder is absent or not laid out as the site says, or the machine's
            joints are not known.
        FrameError: an image is not what its camera delivers.
    """
    groups = image_groups(site)
    known = joints if joints is not None else _own_joints(site)
    if site.entry.machine is not None and known is None:
        raise SiteError(
            f"{site.path}: joints of the machine are not recorded; give them with --joints name=value,..."
        )
    return (_moment(group, known) for group in groups)


def check_images(site: Site) -> tuple[int, int]:
    """Looks at the header of every image that `moments` would read.

    Returns:
        Number of moments and of images.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    groups = image_groups(site)
    for group in groups:
        for image in group:
            image.check()
    return len(groups), len({image.path for group in groups for image in group})


def silent_cameras(site: Site) -> tuple[str, ...]:
    """Names of the cameras that no moment has an image of: as if lost, they dispute all that they look at.

    Raises:
        SiteError: as `moments`.
    """
    heard = {image.camera.name for group in image_groups(site) for image in group}
    return tuple(camera.name for camera in site.cameras() if camera.name not in heard)


def excluded_frames(site: Site) -> tuple[tuple[DepthCamera, DepthFrame], ...]:
    """For layout `seven_scenes`, the views that the site leaves out, to check with; otherwise none.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    cameras = site.excluded_cameras()
    if not cameras:
        return ()
    return tuple((image.camera, image.read()) for image in _views(site, cameras))


def image_groups(site: Site) -> list[list[Image]]:
    """The images of each moment, unread.

    Raises:
        SiteError: as `moments`.
    """
    recording, folder = site.entry.recording, site.recording_folder()
    if isinstance(recording, SevenScenes):
        return [_views(site, site.cameras())]
    if isinstance(recording, StamplessFolder):
        return _by_order(site, recording, folder)
    assert isinstance(recording, StampedFolder)
    return _by_time(site, recording, folder)


def _moment(group: list[Image], joints: Positions | JointRecord | None) -> RecordedMoment:
    frames = tuple(image.read() for image in group)
    stamps = [frame.stamp_ns for frame in frames if frame.stamp_ns is not None]
    stamp = max(stamps) if stamps else None
    if joints is None:
        return RecordedMoment(stamp, frames)
    return RecordedMoment(
        stamp, frames, _at(joints, stamp), {frame.camera: _at(joints, frame.stamp_ns) for frame in frames}
    )


def _at(joints: Positions | JointRecord, stamp_ns: int | None) -> Positions:
    if not isinstance(joints, JointRecord):
        return joints
    if stamp_ns is None:
        raise SiteError(
            "frames have no times, so a record of joints cannot be asked; give positions that hold throughout"
        )
    return joints.at(stamp_ns)


def _own_joints(site: Site) -> JointRecord | None:
    recording = site.entry.recording
    if not isinstance(recording, StampedFolder):
        return None
    folder = site.recording_folder()
    path = folder / inside(folder, recording.joints_file)
    if not path.exists() and site.entry.machine is None:
        return None
    return JointRecord.from_csv(path, max_gap_ns=round(recording.max_joint_gap_ms * 1e6))


def _image(site: Site, camera: DepthCamera, stamp_ns: int | None, path: Path) -> Image:
    return Image(camera, stamp_ns, path, site.depth_scale_m(camera.name))


def _views(site: Site, cameras: tuple[DepthCamera, ...]) -> list[Image]:
    folder = site.recording_folder()
    return [_image(site, camera, None, folder / f"{camera.name}.depth.png") for camera in cameras]


def _by_order(site: Site, recording: StamplessFolder, folder: Path) -> list[list[Image]]:
    known = [camera.name for camera in site.cameras()]
    for name in recording.files:
        if name not in known:
            raise SiteError(
                f"{site.path}: recording.files: unknown camera {name!r}; cameras are {', '.join(known)}"
            )
    rows = [
        [_image(site, camera, None, path) for path in _files_of(site, recording, folder, camera.name)]
        for camera in site.cameras()
    ]
    counts = [len(row) for row in rows]
    if len(set(counts)) != 1:
        found = ", ".join(f"{name} {count}" for name, count in zip(known, counts, strict=True))
        raise SiteError(
            f"{site.path}: recording: frames per camera are {found}; without times they must be as many"
        )
    return [list(group) for group in zip(*rows, strict=True)]


def _files_of(site: Site, recording: StamplessFolder, folder: Path, camera: str) -> list[Path]:
    given = recording.files.get(camera, f"{camera}/*.png")
    what = f"{site.path}: recording.files.{camera}"
    if not isinstance(given, str):
        doubled = sorted({name for name in given if given.count(name) > 1})
        if doubled:
            raise SiteError(f"{what}: {doubled[0]} is there twice; one frame per camera and moment")
        return [folder / inside(folder, name) for name in given]
    paths = sorted(folder.glob(inside(folder, given)))
    if not paths:
        raise SiteError(f"{what}: no file {given} in {folder}; expected 16-bit PNG images")
    return paths


def _by_time(site: Site, recording: StampedFolder, folder: Path) -> list[list[Image]]:
    cameras = site.cameras()
    _refuse_unknown(site, recording, folder, {camera.name for camera in cameras})
    series = [_stamped(site, camera, folder / camera.name) for camera in cameras]
    leader = max(series, key=len)
    if not leader:
        raise SiteError(f"{site.path}: recording: no frames; expected {folder}/<camera>/<stamp_ns>.png")
    skew_ns = round(recording.max_skew_ms * 1e6)
    groups = []
    for lead in leader:
        near = [_nearest(row, lead.stamp_ns or 0, skew_ns) for row in series]
        groups.append([image for image in near if image is not None])
    return groups


def _refuse_unknown(site: Site, recording: StampedFolder, folder: Path, known: set[str]) -> None:
    for path in sorted(folder.iterdir()):
        if (
            path.is_dir()
            and path.name not in known
            and path.name not in recording.ignore
            and any(path.glob("*.png"))
        ):
            raise SiteError(
                f"{path}: images of an unknown camera; cameras are {', '.join(sorted(known))}, "
                "others are named in recording.ignore"
            )


def _stamped(site: Site, camera: DepthCamera, folder: Path) -> list[Image]:
    """A camera's images by rising time; none if it has no folder: it gave nothing."""
    images: dict[int, Image] = {}
    for path in sorted(folder.glob("*.png")):
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
        images[stamp] = _image(site, camera, stamp, path)
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
