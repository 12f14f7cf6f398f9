"""Frames matched with their cameras and made pinhole: what carving and explaining start from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError, FrameError
from elbowroom.geometry import DepthCamera
from elbowroom.sensing import DepthFrame, rectified, rectify

Image = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class RoomImages:
    """The newest images of a group of pinhole cameras.

    Args:
        cameras: pinhole, all of the group.
        least_m, greatest_m: by camera, bounds of depth per pixel, shape (height, width) [m]; those without a frame
            are missing. Without distortion both are the frame's own image.
        aged_m: by camera, how far anything may have moved since its image was exposed [m]; one that is missing: not at
            all.
    """

    cameras: tuple[DepthCamera, ...]
    least_m: Mapping[str, Image]
    greatest_m: Mapping[str, Image]
    aged_m: Mapping[str, float] = field(default_factory=dict)

    def of(self, *names: str) -> Self:
        """Those of some cameras alone."""
        return type(self)(
            tuple(camera for camera in self.cameras if camera.name in names),
            {camera: image for camera, image in self.least_m.items() if camera in names},
            {camera: image for camera, image in self.greatest_m.items() if camera in names},
            {camera: far for camera, far in self.aged_m.items() if camera in names},
        )


def room_images(
    cameras: Sequence[DepthCamera],
    frames: Sequence[DepthFrame],
    aged_m: Mapping[str, float] | None = None,
) -> RoomImages:
    """Matches frames with cameras and brings distorted images to pinhole images.

    Args:
        cameras: of a group.
        frames: at most one of each of them.
        aged_m: by camera, how far anything may have moved since its frame [m]; None: not at all.

    Raises:
        CameraError: a camera named twice, or a frame of an unknown camera.
        FrameError: two frames of one camera, or a frame of another size than its camera's.
    """
    given = frames_by_camera(cameras, frames)
    least, greatest = {}, {}
    for camera in cameras:
        frame = given.get(camera.name)
        if frame is None:
            continue
        if camera.intrinsics.is_distorted:
            _, least[camera.name], greatest[camera.name] = rectify(camera, frame)
        else:
            least[camera.name] = greatest[camera.name] = frame.depth_m
    known = {frame.camera for frame in frames}
    aged = {name: far for name, far in (aged_m or {}).items() if name in known and far > 0}
    return RoomImages(tuple(pinhole_of(camera) for camera in cameras), least, greatest, aged)


@lru_cache(maxsize=256)
def pinhole_of(camera: DepthCamera) -> DepthCamera:
    """The camera itself, or the pinhole twin of a distorted one: always the same object, so that layouts are kept."""
    return rectified(camera) if camera.intrinsics.is_distorted else camera


def frames_by_camera(cameras: Sequence[DepthCamera], frames: Sequence[DepthFrame]) -> dict[str, DepthFrame]:
    """Frames by camera name, checked.

    Raises:
        CameraError: a camera named twice, or a frame of an unknown camera.
        FrameError: two frames of one camera, or a frame of another size than its camera's.
    """
    known: dict[str, DepthCamera] = {}
    for camera in cameras:
        if camera.name in known:
            raise CameraError(f"cameras: {camera.name} is there twice, names must differ")
        known[camera.name] = camera
    given: dict[str, DepthFrame] = {}
    for frame in frames:
        of = known.get(frame.camera)
        if of is None:
            raise CameraError(
                f"frames: camera {frame.camera} is unknown, known are {', '.join(known) or 'none'}"
            )
        if frame.camera in given:
            raise FrameError(f"frames: two frames of camera {frame.camera}, one each is allowed")
        if frame.depth_m.shape != (of.height, of.width):
            raise FrameError(
                f"frames: camera {of.name} delivers {of.width} x {of.height} pixels, "
                f"this frame has {frame.depth_m.shape[1]} x {frame.depth_m.shape[0]}"
            )
        given[frame.camera] = frame
    return given
