"""The watch of a run: from the site's reference, or commissioned at the start where the room is simulated."""

import numpy as np

from elbowroom.cli.progress import Steps
from elbowroom.cli.room import Room
from elbowroom.errors import CalibrationError
from elbowroom.monitor import CameraReference, Tolerance, Watch, load_references
from elbowroom.monitor.health.drift.commission import Commissioning

FRAMES = 12
EVERY_S = 0.9
"""Frames of a simulated room from which it is commissioned, and how far apart they are."""
COMMISSION_AT_S = 1000.0
"""The time of the simulated room at which that begins: not what will be watched."""
UNWATCHED = (
    "cameras are not watched, one that is knocked goes unnoticed; see `elbowroom calibrate commission`"
)


def watch_of(room: Room, steps: Steps) -> tuple[Watch | None, str | None]:
    """The watch over a room, or None and why there is none.

    Args:
        room: with its cameras.
        steps: shows that a simulated room is being commissioned.

    Raises:
        SiteError, CalibrationError: the site names a reference that is missing, damaged, or of other cameras.
    """
    entry, site = room.site.entry.watch, room.site
    if entry is not None:
        path = entry.reference_path(site.path.parent)
        tolerance = Tolerance(float(np.radians(entry.turn_deg)), entry.move_mm / 1e3)
        references = load_references(path)
        try:
            return Watch(room.cameras, references, room.machine, tolerance), None
        except CalibrationError as error:
            raise CalibrationError(f"{path}: {error}") from None
    if site.simulated is None:
        return None, UNWATCHED
    steps.begin("commissioning the simulated cameras")
    try:
        return Watch(room.cameras, _commissioned(room, site.simulated.seed), room.machine), None
    except CalibrationError as error:
        return None, f"cameras are not watched: {error}"


def _commissioned(room: Room, seed: int) -> tuple[CameraReference, ...]:
    """References of a simulated room, from a time of its own."""
    from elbowroom.simulate import InterventionRoom, render

    simulated = InterventionRoom(machine=room.machine)
    commissioning = Commissioning(room.cameras, room.machine, FRAMES)
    for number in range(FRAMES):
        moment = simulated.at(COMMISSION_AT_S + number * EVERY_S)
        commissioning.add(render(room.cameras, moment, seed=seed + number), moment.joints)
    return commissioning.references()
