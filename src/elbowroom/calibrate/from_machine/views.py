"""A machine that went through poses before the cameras: images, and where its joints were at each."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.machine import Machine
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sensing.planar_images import PlanarImages, planar_images

LEAST_POSES = 4
"""Fewer poses say too little of how far they agree with each other."""
SAME_POSE = 0.01
"""Joints that differ by less than this count as the same pose [m or rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class MachineViews:
    """What one camera saw of the machine.

    Args:
        images: of all poses that it has an image of.
        poses: which they are, shape (n,): numbers that all cameras share.
        positions: of the joints at each, shape (n, joints) [m or rad].
        base_from_links: where the links are at each, shape (n, links, 4, 4).
    """

    images: PlanarImages
    poses: NDArray[np.int64]
    positions: NDArray[np.float64]
    base_from_links: NDArray[np.float64]

    @property
    def camera(self) -> DepthCamera:
        """The camera as the site has it."""
        return self.images.camera

    def coarser(self, step: int) -> "MachineViews":
        """The same with every so many pixels."""
        return replace(self, images=self.images.coarser(step))


def machine_views(
    machine: Machine, cameras: Sequence[DepthCamera], moments: Iterable[Snapshot]
) -> tuple[MachineViews, ...]:
    """Images and joints of a recording, camera by camera.

    A moment whose joints differ from those before by less than `SAME_POSE` is a pose again, and is left out.

    Args:
        machine: at its place in the world.
        cameras: to calibrate.
        moments: one per pose, with the joints at each frame's time.

    Raises:
        CalibrationError: joints are not known, too few poses, or a camera without images.
        MachineError: joints that the machine cannot have.
    """
    kept: dict[str, list[tuple[int, DepthFrame, NDArray]]] = {camera.name: [] for camera in cameras}
    taken: list[NDArray] = []
    for moment in moments:
        if moment.joints is None:
            raise CalibrationError(
                f"machine {machine.name}: its joints are not recorded; capture again with a joints.csv of all joints"
            )
        here = machine.positions(moment.joints)
        if any(np.abs(here - other).max() < SAME_POSE for other in taken):
            continue
        taken.append(here)
        for frame in moment.frames:
            if frame.camera in kept:
                positions = machine.positions(moment.joints_at(frame.camera) or {})
                kept[frame.camera].append((len(taken) - 1, frame, positions))
    if len(taken) < LEAST_POSES:
        raise CalibrationError(
            f"machine {machine.name}: {len(taken)} different poses, at least {LEAST_POSES} are needed and 12 are good; "
            "move every joint and capture again"
        )
    return tuple(_views(machine, camera, kept[camera.name]) for camera in cameras)


def _views(
    machine: Machine, camera: DepthCamera, kept: list[tuple[int, DepthFrame, NDArray]]
) -> MachineViews:
    if len(kept) < LEAST_POSES:
        raise CalibrationError(
            f"camera {camera.name}: images of {len(kept)} poses, at least {LEAST_POSES} are needed; "
            "look whether it was running, or leave it out"
        )
    positions = np.stack([positions for _, _, positions in kept])
    placed = machine.world_from_link_array(positions)
    return MachineViews(
        planar_images(camera, [frame for _, frame, _ in kept]),
        np.array([pose for pose, _, _ in kept]),
        positions,
        invert_rigid(machine.world_from_base) @ placed,
    )
