"""What in a room's images is the machine itself."""

from elbowroom.errors import InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.machine import Explained, Machine, explain_frames
from elbowroom.reconstruct.images import RoomImages
from elbowroom.reconstruct.terms import Terms
from elbowroom.sensing import Snapshot

TOLERANCE_SIGMAS = 5.5
"""What is explained lies within so many sigmas of the model, besides the tolerance."""
NOTHING = Explained({}, None)
"""Of a bare room."""


def explain(
    grid: VoxelGrid,
    machine: Machine | None,
    images: RoomImages,
    snapshot: Snapshot,
    terms: Terms,
    sigmas: float = TOLERANCE_SIGMAS,
) -> Explained:
    """Which pixels show the machine, and what else was seen near its body.

    Args:
        grid: the watched box.
        machine: None: the bare room, nothing is explained.
        images: of the room's cameras.
        snapshot: says where the machine was at the time of each image.
        terms: the tolerance, and by how much the body is grown.
        sigmas: of the tolerance.

    Raises:
        InputError: a machine, and nobody knows where it is.
        MachineError: joints that are unknown, missing or out of their limits.
    """
    if machine is None:
        return NOTHING
    if snapshot.joints is None:
        raise InputError("reconstruct: a machine without joints; give its joint positions by name")
    seen = [camera for camera in images.cameras if camera.name in images.least_m]
    return explain_frames(
        machine,
        seen,
        [images.least_m[camera.name] for camera in seen],
        [snapshot.joints_of.get(camera.name, snapshot.joints) for camera in seen],
        tolerance_m=terms.explain_tolerance_m,
        tolerance_sigmas=sigmas,
        grid=grid,
        growth_m=terms.body_growth_m,
    )
