"""Layout `seven_scenes`: each frame is a camera of its own, all of them together are one moment."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from elbowroom.errors import SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.site.site import Site
from elbowroom.sources.layouts.image import Image


@dataclass(frozen=True, slots=True, eq=False)
class SevenScenesFrames:
    """A recording of this layout (`Layout`).

    Args:
        site: that names it.
        folder: where it lies.
    """

    site: Site
    folder: Path

    def moments(self) -> list[list[Image]]:
        """One moment, of all frames that the site takes."""
        return [self.images_of(self.site.cameras())]

    def by_camera(self) -> NoReturn:
        """No camera stands still.

        Raises:
            SiteError: always.
        """
        raise SiteError(f"{self.site.path}: recording: layout seven_scenes has no cameras that stand still")

    def joints(self) -> None:
        """None are recorded."""

    def images_of(self, cameras: Sequence[DepthCamera]) -> list[Image]:
        """The image of each of these cameras."""
        return [
            Image.of(self.site, camera, None, self.folder / f"{camera.name}.depth.png") for camera in cameras
        ]
