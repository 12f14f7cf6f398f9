"""What makes a camera fit that does not: its images belong to other poses of the machine, or to another camera."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from elbowroom.calibrate.from_machine.drawn_machine import DrawnMachine
from elbowroom.calibrate.from_machine.start import misfit, start
from elbowroom.calibrate.from_machine.views import LEAST_POSES, MachineViews
from elbowroom.errors import CalibrationError

FITS_M = 0.03
"""What moved lies so near to the machine's surface where a camera is right, a rough pose and all [m]."""
SHIFTS = (-1, 1, -2, 2)
"""By so many poses a camera may be late."""


def explained(
    drawn: DrawnMachine, views: MachineViews, everyone: Sequence[MachineViews], refused: Sequence[str]
) -> str | None:
    """What makes a camera fit, and what to do; None: nothing that was tried.

    Args:
        drawn: the machine, where its base is.
        views: of the camera, which does not fit as it is.
        everyone: of all cameras.
        refused: names of those that do not fit, which may have been exchanged.
    """
    for shift in SHIFTS:
        moved = _shifted(views, everyone, shift)
        if moved is not None and _fits(drawn, moved):
            count = "one pose" if abs(shift) == 1 else f"{abs(shift)} poses"
            return (
                f"its images fit the joints of {count} {'before' if shift < 0 else 'after'}: it is "
                f"{'late' if shift < 0 else 'early'}, or its clock is; correct its stamps, or capture again"
            )
    for other in everyone:
        name = other.camera.name
        if name == views.camera.name or name not in refused or not _alike(views, other):
            continue
        if _fits(drawn, _at_place_of(views, other)) and _fits(drawn, _at_place_of(other, views)):
            return f"its images fit at the place of camera {name}, and the other way round: exchange the two folders"
    return None


def _fits(drawn: DrawnMachine, views: MachineViews) -> bool:
    try:
        return misfit(drawn, views, start(drawn, views)) < FITS_M
    except CalibrationError:
        return False


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
