"""Which images of a recording belong to which moment, by each of the layouts; nothing is read yet."""

from bisect import bisect_left
from pathlib import Path
from typing import NamedTuple

from elbowroom.errors import FrameError, SiteError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame
from elbowroom.site.paths import inside
from elbowroom.site.recording_entry import SevenScenes, StampedFolder, StamplessFolder
from elbowroom.site.site import Site
from elbowroom.sources.depth_png import check_depth_png, read_depth_png


class Image(NamedTuple):
    """An image on disk that has not been read."""

    camera: DepthCamera
    stamp_ns: int | None
    path: Path
    scale_m: float
    bias_m: float = 0.0

    def read(self) -> DepthFrame:
        """The frame.

        Raises:
            FrameError: the file is not what its camera delivers.
        """
        raw = read_depth_png(self.path, self.camera.width, self.camera.height)
        return DepthFrame.from_raw(
            self.camera.name, self.stamp_ns, raw, scale_m=self.scale_m, bias_m=self.bias_m
        )

    def check(self) -> None:
        """Looks at the file's header alone; raises FrameError as `read` would."""
        check_depth_png(self.path, self.camera.width, self.camera.height)


def image_groups(site: Site) -> list[list[Image]]:
    """The images of each moment, unread.

    Raises:
        SiteError: as `moments`.
    """
    recording, folder = site.entry.recording, site.recording_folder()
    if isinstance(recording, SevenScenes):
        return [views(site, site.cameras())]
    if isinstance(recording, StamplessFolder):
        return _by_order(site, recording, folder)
    assert isinstance(recording, StampedFolder)
    return _by_time(site, recording, folder)


def images_of_cameras(site: Site) -> dict[str, list[Image]]:
    """Each camera's images, unread, by time or by order; a camera without a folder has none.

    Raises:
        SiteError: no recording, one of layout `seven_scenes`, or not laid out as the site says.
        FrameError: two images of a camera at one time, or a name that is no time.
    """
    recording, folder = site.entry.recording, site.recording_folder()
    if isinstance(recording, SevenScenes):
        raise SiteError(f"{site.path}: recording: layout seven_scenes has no cameras that stand still")
    if isinstance(recording, StamplessFolder):
        groups = _by_order(site, recording, folder)
        return {images[0].camera.name: list(images) for images in zip(*groups, strict=True)}
    assert isinstance(recording, StampedFolder)
    _refuse_unknown(site, recording, folder, {camera.name for camera in site.cameras()})
    return {camera.name: _stamped(site, camera, folder / camera.name) for camera in site.cameras()}


def _image(site: Site, camera: DepthCamera, stamp_ns: int | None, path: Path) -> Image:
    name = camera.name
    return Image(camera, stamp_ns, path, site.depth_scale_m(name), site.depth_bias_m(name))


def views(site: Site, cameras: tuple[DepthCamera, ...]) -> list[Image]:
    """For layout `seven_scenes`, the image of each camera."""
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
