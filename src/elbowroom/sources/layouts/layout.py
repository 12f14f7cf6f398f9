"""What every layout of a recording answers, and which one a site's recording has."""

from typing import Protocol

from elbowroom.sensing import JointRecord
from elbowroom.site.recording_entry import BagRecording, SevenScenes, StampedFolder, StamplessFolder
from elbowroom.site.site import Site
from elbowroom.sources.layouts.bag import BagFrames
from elbowroom.sources.layouts.folder import Folder
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.layouts.seven_scenes import SevenScenesFrames
from elbowroom.sources.layouts.stampless import Stampless


class Layout(Protocol):
    """Which images of a recording belong together. Nothing is read yet; what is not laid out as the site says is a
    SiteError, a file whose name does not fit a FrameError."""

    def moments(self) -> list[list[Image]]:
        """The images of each moment, at most one of each camera."""

    def by_camera(self) -> dict[str, list[Image]]:
        """Each camera's images, by time or by order; a camera that gave nothing has none."""

    def joints(self) -> JointRecord | None:
        """The joints that were recorded beside the images; None: none were."""


def layout_of(site: Site) -> Layout:
    """The layout of a site's recording.

    Raises:
        SiteError: the site has no recording, or its folder is absent.
    """
    folder, recording = site.recording_folder(), site.entry.recording
    if isinstance(recording, StampedFolder):
        return Folder(site, recording, folder)
    if isinstance(recording, StamplessFolder):
        return Stampless(site, recording, folder)
    if isinstance(recording, BagRecording):
        return BagFrames(site, recording, folder)
    assert isinstance(recording, SevenScenes)
    return SevenScenesFrames(site, folder)
