"""What makes a camera fit that does not: its images belong to other poses of the machine, or to another camera."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.fit import fit
from elbowroom.calibrate.from_machine.start import start
from elbowroom.calibrate.from_machine.verdict import check_camera
from elbowroom.calibrate.from_machine.views import LEAST_POSES, MachineViews
from elbowroom.errors import CalibrationError
from elbowroom.machine import Machine

MOST_OTHERS = 6
"""Cameras that one may have been exchanged with, which are tried."""
SHIFTS = (-1, 1, -2, 2)
"""By so many poses a camera may be late."""


def explained(
    machine: Machine, views: MachineViews, everyone: Sequence[MachineViews], refused: Sequence[str]
) -> str | None:
    """What makes a camera fit, and what to do; None: nothing that was tried.

    Args:
        machine: where its base is.
        views: of the camera, which does not fit as it is.
        everyone: of all cameras.
        refused: names of those that do not fit, which are the first to have been exchanged.
    """
    for shift in SHIFTS:
        moved = _shifted(views, everyone, shift)
        if moved is not None and _fits(machine, moved):
            count = "one pose" if abs(shift) == 1 else f"{abs(shift)} poses"
            return (
                f"its images fit the joints of {count} {'before' if shift < 0 else 'after'}: it is "
                f"{'late' if shift < 0 else 'early'}, or its clock is; correct its stamps, or capture again"
            )
    others = [one for one in everyone if one.camera.name != views.camera.name and _alike(views, one)]
    others.sort(key=lambda one: one.camera.name not in refused)
    for other in others[:MOST_OTHERS]:
        name = other.camera.name
        if _fits(machine, _at_place_of(views, other)) and _fits(machine, _at_place_of(other, views)):
            return f"its images fit at the place of camera {name}, and the other way round: exchange the two folders"
    return None


def _fits(machine: Machine, views: MachineViews) -> bool:
    """Whether the camera alone is found from these views, as any camera is."""
    try:
        begun = start(DrawnMachine(machine, machine.world_from_base), views)
        found = fit(machine, [views], {views.camera.name: begun}, {}, free_base=False, model_sigma_m=None)
        check_camera(machine, views, found)
    except CalibrationError:
        return False
    return True


def _shifted(views: MachineViews, everyone: Sequence[MachineViews], shift: int) -> MachineViews | None:
    """The camera's images with the joints of other poses."""
    known = {
        int(pose): (positions, links)
        for one in everyone
        for pose, positions, links in zip(one.poses, one.positions, one.base_from_links, strict=True)
    }
    rows = [n for n, pose in enumerate(views.poses) if int(pose) + shift in known]
    if len(rows) < LEAST_POSES:
        return None
    poses = views.poses[rows] + shift
    return MachineViews(
        replace(views.images, depth_m=views.images.depth_m[rows]),
        poses,
        np.stack([known[int(pose)][0] for pose in poses]),
        np.stack([known[int(pose)][1] for pose in poses]),
    )


def _alike(one: MachineViews, other: MachineViews) -> bool:
    return one.images.depth_m.shape[1:] == other.images.depth_m.shape[1:]


def _at_place_of(views: MachineViews, other: MachineViews) -> MachineViews:
    """The images of one camera, taken for those of another."""
    images = replace(other.images, depth_m=views.images.depth_m)
    return MachineViews(images, views.poses, views.positions, views.base_from_links)
