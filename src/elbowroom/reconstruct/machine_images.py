"""Images with where the machine's joints were when each was taken."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.machine.joint_state import Joints
from elbowroom.reconstruct.images import room_images
from elbowroom.sensing import Snapshot


class MachineImages(NamedTuple):
    """Of each camera that gave an image.

    Fields:
        cameras: in the room's order.
        depths: `RoomImages.least_m`, shape (height, width) each [m].
        joints: by name, at the image's time [m or rad].
    """

    cameras: Sequence[DepthCamera]
    depths: Sequence[NDArray[np.float32]]
    joints: Sequence[Joints]


def machine_images(cameras: Sequence[DepthCamera], snapshot: Snapshot) -> MachineImages | None:
    """The images of a moment; None: it is not known where the machine was.

    Args:
        cameras: of the room.
        snapshot: their frames, and where the joints were.

    Raises:
        CameraError, FrameError: frames of other cameras or sizes.
    """
    if snapshot.joints is None:
        return None
    images = room_images(cameras, snapshot.frames)
    seen = [camera for camera in images.cameras if camera.name in images.least_m]
    return MachineImages(
        seen,
        [images.least_m[camera.name] for camera in seen],
        [snapshot.joints_of.get(camera.name, snapshot.joints) for camera in seen],
    )
