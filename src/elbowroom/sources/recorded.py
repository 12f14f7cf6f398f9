"""Recorded frames of all cameras, moment by moment."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from elbowroom.errors import SiteError
from elbowroom.finding import Finding
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot
from elbowroom.site.site import Site
from elbowroom.sources.joint_clock import joint_clock_text
from elbowroom.sources.layouts.bag import BagFrames
from elbowroom.sources.layouts.folder import Folder
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.layouts.layout import layout_of
from elbowroom.sources.layouts.seven_scenes import SevenScenesFrames
from elbowroom.sources.layouts.stampless import Stampless
from elbowroom.sources.room_clock import clock_text
from elbowroom.sources.times.clock import ClockEstimate
from elbowroom.sources.times.company import require_company
from elbowroom.sources.times.joints import joint_findings
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.numbers import padding_findings
from elbowroom.sources.times.oddities import findings_of

Joints = Mapping[str, float] | JointRecord
"""Positions by name that hold throughout [m or rad], or a record of them."""


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """The recording of a site as a source, played once.

    Args:
        site: with a recording.
        joints: as of `moments`.
    """

    site: Site
    joints: Joints | None = None

    @property
    def name(self) -> str:
        """What its time is spent on."""
        return "reading"

    def __iter__(self) -> Iterator[Snapshot]:
        """The moments, from the first one.

        Raises:
            SiteError: no moment has images of two cameras, though several have some: nothing could be judged.
            InputError: as `moments`.
        """
        times = times_of(self.site)
        if times is not None:
            require_company(self.site.path, times)
        return moments(self.site, self.joints)

    def close(self) -> None:
        """Nothing is held between two moments."""


def moments(site: Site, joints: Joints | None = None) -> Iterator[Snapshot]:
    """The moments of a site's recording, in order; images are read one moment at a time.

    The time of a moment is that of its latest frame. Frames are in the order of the site's cameras; a camera without
    one near the moment is left out.

    Args:
        site: with a recording.
        joints: positions that hold throughout, or a record; None: the recording's own, if it has any.

    Raises:
        SiteError: no recording, its folder is absent or not laid out as the site says, or the machine's
            joints are not known.
        FrameError: an image is not what its camera delivers.
        JointsError: a record of joints does not know where the machine was at a frame's time.
        InputError: a record of joints, and frames without times.
    """
    layout = layout_of(site)
    groups = layout.moments()
    known = joints if joints is not None else layout.joints()
    require_joints(site, known)
    return (_snapshot(group, known) for group in groups)


def first_known(site: Site) -> Snapshot | None:
    """The first moment of which it is known where the machine was; None: there is none, or no moment at all.

    Recorders do not begin all topics at once, so that images often come before joints.

    Args:
        site: with a recording.

    Raises:
        SiteError, FrameError, InputError: as `moments`, but for moments of which a record of joints knows nothing.
    """
    layout = layout_of(site)
    groups, known = layout.moments(), layout.joints()
    require_joints(site, known)
    if isinstance(layout, Folder | BagFrames):
        require_company(site.path, layout.meeting)
    for group in groups:
        stamps = [image.stamp_ns for image in group if image.stamp_ns is not None]
        if isinstance(known, JointRecord) and not all(map(known.knows, stamps)):
            continue
        return _snapshot(group, known)
    return None


def require_joints(site: Site, known: Joints | None) -> None:
    """Refuses a recording of which nobody knows where its machine was, unless it was not there.

    Args:
        site: with a recording.
        known: its joints.

    Raises:
        SiteError: there is a machine, and none.
    """
    recording = site.entry.recording
    is_absent = recording is not None and recording.without_machine
    if site.entry.has_machine and known is None and not is_absent:
        raise SiteError(
            f"joints: {site.path} records none of its machine; give positions that hold throughout"
        )


def check_images(site: Site) -> tuple[int, int]:
    """Looks at the header of every image that `moments` would read.

    Returns:
        Number of moments and of images.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    groups = layout_of(site).moments()
    for group in groups:
        for image in group:
            image.check()
    return len(groups), len({image.path for group in groups for image in group})


def silent_cameras(site: Site) -> tuple[str, ...]:
    """Names of the cameras that have no image at all: as if lost, they dispute all that they look at.

    Raises:
        SiteError: as `moments`.
    """
    layout = layout_of(site)
    rows = layout.by_camera() if not isinstance(layout, SevenScenesFrames) else {}
    return tuple(name for name, row in rows.items() if not row)


def times_of(site: Site) -> Meeting | None:
    """When the images of a recording were taken, and who meets whom; None: they have no times.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    layout = layout_of(site) if site.entry.recording is not None else None
    return layout.meeting if isinstance(layout, Folder | BagFrames) else None


def clocks_of(site: Site) -> Mapping[str, ClockEstimate]:
    """What a bag says of its cameras' clocks beside the recorder's, at its end; of no other recording anything.

    Raises:
        SiteError, BagError, FrameError: as `moments`.
    """
    layout = layout_of(site) if site.entry.recording is not None else None
    return layout.clocks() if isinstance(layout, BagFrames) else {}


def time_findings(site: Site) -> tuple[Finding, ...]:
    """What is odd about the times of a recording, though each moment can be judged.

    Raises:
        SiteError, FrameError, JointsError: as `moments`.
    """
    layout = layout_of(site) if site.entry.recording is not None else None
    if isinstance(layout, Stampless):
        return padding_findings({name: [i.path for i in row] for name, row in layout.by_camera().items()})
    if not isinstance(layout, Folder | BagFrames):
        return ()
    layout.moments()
    record = layout.joints() if site.entry.has_machine and layout.joints_path.exists() else None
    joints = (
        ()
        if record is None
        else joint_findings(layout.joints_path, record, layout.meeting, isinstance(layout, BagFrames))
    )
    notes = layout.notes if isinstance(layout, BagFrames) else ()
    clocks = layout.clocks() if isinstance(layout, BagFrames) else {}
    joint_clocks = layout.joint_clocks() if isinstance(layout, BagFrames) else {}
    told = [text for name, clock in clocks.items() if (text := clock_text(name, clock)) is not None]
    told += [
        text for topic, one in joint_clocks.items() if (text := joint_clock_text(topic, one)) is not None
    ]
    return (
        *(Finding("bag", (), text, False) for text in (*notes, *told)),
        *findings_of(layout.meeting),
        *joints,
    )


def excluded_frames(site: Site) -> tuple[tuple[DepthCamera, DepthFrame], ...]:
    """For layout `seven_scenes`, the views that the site leaves out, to check with; otherwise none.

    Raises:
        SiteError, FrameError: as `moments`.
    """
    cameras = site.excluded_cameras()
    if not cameras:
        return ()
    images = SevenScenesFrames(site, site.recording_folder()).images_of(cameras)
    return tuple((image.camera, image.read()) for image in images)


def _snapshot(group: list[Image], joints: Joints | None) -> Snapshot:
    frames = [image.read() for image in group]
    stamps = [frame.stamp_ns for frame in frames if frame.stamp_ns is not None]
    return Snapshot.taken(frames, joints, max(stamps, default=None))
