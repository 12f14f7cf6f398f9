"""The looks of a run: what came in is looked at before it is judged."""

from collections.abc import Sequence

from elbowroom.monitor.health.checks import Look
from elbowroom.monitor.health.contradiction_look import ContradictionLook
from elbowroom.monitor.health.drift.reference import CameraReference
from elbowroom.monitor.health.model_look import ModelLook
from elbowroom.monitor.health.nothing_look import NothingLook
from elbowroom.monitor.health.source_look import SourceLook
from elbowroom.monitor.health.streams.streams import Streams, Ways
from elbowroom.monitor.health.values_look import ValuesLook
from elbowroom.site.plausible import look_at_site
from elbowroom.sources import Played, Room
from elbowroom.sources.looked import units_of


def looks_of(room: Room) -> tuple[Look, ...]:
    """All looks at what a room's source brings."""
    said = tuple(look_at_site(room.site))
    is_absent = room.terms.without_machine
    model = () if room.machine is None else (ModelLook(room.cameras, room.machine, is_absent),)
    return (
        ValuesLook(room.grid, room.cameras, units_of(room.site, room.cameras), said),
        ContradictionLook(room.cameras, room.terms.margin),
        NothingLook(room.grid, room.cameras, room.terms.margin),
        *model,
    )


def first_looks_of(room: Room) -> tuple[Look, ...]:
    """What the source says itself of what it brings."""
    return (SourceLook(room.source),) if isinstance(room.source, Played) else ()


def streams_of(room: Room, references: Sequence[CameraReference]) -> Streams:
    """What hears a room's sources.

    Args:
        room: with its cameras.
        references: what they were commissioned on; none: their first good moments count.
    """
    entry = room.site.entry
    machine, joints = room.machine, entry.joints
    greatest = (
        {} if machine is None else {name: joints[name].speed_of(machine.joint(name)) for name in joints}
    )
    ways = Ways(room.terms.max_age_ns, repeating(room), frozenset(entry.health.tolerated), greatest)
    return Streams(room.cameras, room.machine, ways, references)


def repeating(room: Room) -> frozenset[str]:
    """Cameras that give equal images while nothing moves: the site says so, or they are simulated without noise."""
    simulated = room.site.simulated is not None
    return frozenset(
        camera.name
        for camera in room.cameras
        if (simulated and camera.noise is None) or room.site.settings_of(camera.name).get("repeats", False)
    )
