"""The watch of a run: from the site's reference, or commissioned at the start where the room is simulated."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from elbowroom.errors import CalibrationError
from elbowroom.monitor.health.checks import Checks
from elbowroom.monitor.health.drift.commission import Commissioning
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.drift.reference_file import load_references
from elbowroom.monitor.health.drift.tolerance import Tolerance
from elbowroom.monitor.health.drift.watch import Watch
from elbowroom.site import Site
from elbowroom.sources import Room

FRAMES = 12
EVERY_S = 0.9
"""Frames of a simulated room from which it is commissioned, and how far apart they are."""
COMMISSION_AT_S = 1000.0
"""The time of the simulated room at which that begins: not what will be watched."""
UNWATCHED = (
    "cameras are not watched, one that is knocked goes unnoticed; see `elbowroom calibrate commission`"
)


def checks_of(room: Room, begin: Callable[[str], None]) -> Checks:
    """What looks after the cameras and the machine of a room; where nobody watches, it says why.

    Args:
        room: with its cameras.
        begin: told that a simulated room is being commissioned.

    Raises:
        SiteError, CalibrationError: the site names a reference that is missing, damaged, or of other cameras.
    """
    max_age_ns = room.terms.max_age_ns
    if room.site.entry.watch is not None:
        return Checks(_referenced(room), max_age_ns)
    if room.site.simulated is None:
        return Checks(None, max_age_ns, UNWATCHED)
    begin("commissioning the simulated cameras")
    try:
        return Checks(Watch(room.cameras, _commissioned(room), room.machine), max_age_ns)
    except CalibrationError as error:
        return Checks(None, max_age_ns, f"cameras are not watched: {error}")


def _referenced(room: Room) -> Watch:
    """A watch by the reference that the site names."""
    entry = room.site.entry.watch
    assert entry is not None
    path = entry.reference_path(room.site.path.parent)
    references = load_references(path)
    try:
        return Watch(room.cameras, references, room.machine, tolerance_of(room.site))
    except CalibrationError as error:
        raise CalibrationError(f"{path}: {error}") from None


def tolerance_of(site: Site) -> Tolerance:
    """What the site does not yet call moved."""
    entry = site.entry.watch
    if entry is None:
        return Tolerance()
    return Tolerance(float(np.radians(entry.turn_deg)), entry.move_mm / 1e3)


def _commissioned(room: Room) -> tuple[CameraReference, ...]:
    """References of a simulated room, from a time of its own, before anything is knocked."""
    from elbowroom.sources.simulated import Simulated

    assert isinstance(room.source, Simulated)
    still = replace(room.source, joints=None, knocks=())
    commissioning = Commissioning(room.cameras, room.machine, FRAMES)
    for snapshot in still.at(COMMISSION_AT_S + number * EVERY_S for number in range(FRAMES)):
        commissioning.add(snapshot)
    return commissioning.references()
