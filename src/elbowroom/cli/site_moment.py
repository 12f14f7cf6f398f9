"""A first moment of a site, for `elbowroom site check`: recorded, or simulated from the site's own room."""

from typing import TYPE_CHECKING

from elbowroom.errors import InputError

if TYPE_CHECKING:
    from elbowroom.machine import Machine
    from elbowroom.sensing import Snapshot
    from elbowroom.site import Site


def pose_to_draw(site: "Site", machine: "Machine") -> dict[str, float]:
    """Where the machine is first in the recording; without one, at zero, or as near to it as it goes."""
    recorded = None
    if site.entry.recording is not None and site.missing_recording is None:
        recorded = _recorded(site)
    joints = None if recorded is None else recorded.joints
    return machine.nearest_to_zero() if joints is None else dict(joints)


def tight_notes(site: "Site") -> list[str]:
    """Links that stop for as long as a surface is where it is, since it lies within the cameras' margins.

    By the first moment of the recording; where none is there, by images that are simulated of the site's room.
    """
    machine = site.machine()
    if machine is None or not site.motions(machine) or site.simulated is not None:
        return []
    has_images = site.entry.recording is not None and site.missing_recording is None
    if not has_images and (site.entry.room is None or not site.lists_cameras):
        return []
    from rich.console import Console

    from elbowroom.monitor.start.compiling import compile_kernels
    from elbowroom.monitor.why.tight import tight_places
    from elbowroom.sources import open_room

    snapshot = _recorded(site) if has_images else _simulated(site)
    if snapshot is None or snapshot.joints is None:
        return []
    compile_kernels(Console(stderr=True), machine=True, motion=True, simulator=not has_images)
    by = "" if has_images else "by the room that the site describes: "
    try:
        return [f"{by}{tight}" for tight in tight_places(open_room(site), snapshot)]
    except InputError as error:
        return [f"motions were not tried: {error}"]


def _recorded(site: "Site") -> "Snapshot | None":
    """The first moment that knows the joints; None: there is none that has all that it needs, as other commands say."""
    from elbowroom.sources import first_known

    try:
        return first_known(site)
    except InputError:
        return None


def _simulated(site: "Site") -> "Snapshot | None":
    from pathlib import Path

    from elbowroom.cli.simulate_site import site_room
    from elbowroom.sensing import Snapshot
    from elbowroom.simulate import render
    from elbowroom.simulate.scene import Course

    time_s = 100.0
    try:
        room = site_room(site.path, None, Path(), None)
        scene, _ = room.scene(Course((time_s,), moves=False))
        moment = scene.at(time_s)
    except InputError:
        return None
    frames = render(room.cameras, moment, seed=1)
    return Snapshot(tuple(frames), moment.joints, now_ns=moment.stamp_ns)
