"""The looks of a run: what came in is looked at before it is judged."""

from elbowroom.monitor.health.checks import Look
from elbowroom.monitor.health.contradiction_look import ContradictionLook
from elbowroom.monitor.health.model_look import ModelLook
from elbowroom.monitor.health.nothing_look import NothingLook
from elbowroom.monitor.health.source_look import SourceLook
from elbowroom.monitor.health.values_look import ValuesLook
from elbowroom.site.plausible import look_at_site
from elbowroom.sources import Played, Room
from elbowroom.sources.looked import units_of


def looks_of(room: Room) -> tuple[Look, ...]:
    """All looks at what a room's source brings."""
    said = tuple(look_at_site(room.site))
    model = () if room.machine is None else (ModelLook(room.cameras, room.machine),)
    source = (SourceLook(room.source),) if isinstance(room.source, Played) else ()
    return (
        *source,
        ValuesLook(room.grid, room.cameras, units_of(room.site, room.cameras), said),
        ContradictionLook(room.cameras, room.terms.margin),
        NothingLook(room.grid, room.cameras, room.terms.margin),
        *model,
    )
