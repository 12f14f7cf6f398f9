"""Recorded frames of all cameras, moment by moment."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from elbowroom.errors import SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame, JointRecord
from elbowroom.site.paths import inside
from elbowroom.site.recording_entry import StampedFolder
from elbowroom.site.site import Site
from elbowroom.sources.images import Image, image_groups, views

Positions = Mapping[str, float]
"""Joint positions by name [m or rad]."""


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
    return tuple((image.camera, image.read()) for image in views(site, cameras))


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
