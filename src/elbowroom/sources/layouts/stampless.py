"""Layout `stampless`: images without times, the n-th of each camera, in order of names, make the n-th moment."""

from dataclasses import dataclass
from pathlib import Path

from elbowroom.errors import SiteError
from elbowroom.site.paths import inside
from elbowroom.site.recording_entry import StamplessFolder
from elbowroom.site.site import Site
from elbowroom.sources.layouts.image import Image
from elbowroom.sources.times.numbers import natural, require_agreement


@dataclass(frozen=True, slots=True, eq=False)
class Stampless:
    """A recording of this layout (`Layout`).

    Args:
        site: that names it.
        recording: what the site says of it.
        folder: where it lies.
    """

    site: Site
    recording: StamplessFolder
    folder: Path

    def moments(self) -> list[list[Image]]:
        """The n-th images of all cameras, for each n.

        Raises:
            SiteError: an unknown camera, a file that is named twice, no files, not as many of each camera, or names of
                one moment whose numbers differ.
        """
        return [list(group) for group in zip(*self.by_camera().values(), strict=True)]

    def by_camera(self) -> dict[str, list[Image]]:
        """Each camera's images, in order; raises as `moments`."""
        cameras = self.site.cameras()
        known = [camera.name for camera in cameras]
        for name in self.recording.files:
            if name not in known:
                raise SiteError(
                    f"{self.site.path}: recording.files: unknown camera {name!r}; cameras are {', '.join(known)}"
                )
        paths = {name: self._files_of(name) for name in known}
        # what is listed belongs together by the site's word, whatever its names are
        listed = [name for name, given in self.recording.files.items() if not isinstance(given, str)]
        require_agreement(self.site.path, paths, listed)
        return {
            camera.name: [Image.of(self.site, camera, None, path) for path in paths[camera.name]]
            for camera in cameras
        }

    def joints(self) -> None:
        """None are recorded."""

    def _files_of(self, camera: str) -> list[Path]:
        kind = "png" if any(self.folder.glob(f"{camera}/*.png")) else "pgm"
        given = self.recording.files.get(camera, f"{camera}/*.{kind}")
        what = f"{self.site.path}: recording.files.{camera}"
        if not isinstance(given, str):
            doubled = sorted({name for name in given if given.count(name) > 1})
            if doubled:
                raise SiteError(f"{what}: {doubled[0]} is there twice; one frame per camera and moment")
            return [self.folder / inside(self.folder, name) for name in given]
        paths = sorted(self.folder.glob(inside(self.folder, given)), key=natural)
        if not paths:
            raise SiteError(f"{what}: no file {given} in {self.folder}; expected 16-bit PNG or PGM images")
        return paths
