"""Zones that a person declares, as a site file describes them."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from elbowroom.errors import SiteError
from elbowroom.machine import Machine, Zone
from elbowroom.machine.ways import never_out_of
from elbowroom.site.entry import Entry, Point, Text
from elbowroom.site.paths import expand


class ZoneEntry(Entry):
    """A box or a convex mesh of the room: kept out of by all links, or not watched for some, for a reason."""

    name: Text
    kind: Literal["kept_out", "not_watched"]
    lower_m: Point | None = None
    upper_m: Point | None = None
    mesh: Text | None = None
    links: tuple[Text, ...] = ()
    reason: Annotated[str, Field(max_length=1000)] = ""

    @model_validator(mode="after")
    def _one_shape(self) -> "ZoneEntry":
        box = self.lower_m is not None and self.upper_m is not None
        if (self.lower_m is None) != (self.upper_m is None) or box == (self.mesh is not None):
            raise ValueError("either lower_m and upper_m, or mesh")
        if self.kind == "kept_out" and self.links:
            raise ValueError("no links where all are kept out")
        if self.kind == "not_watched" and not (self.links and self.reason):
            raise ValueError(
                "links and a reason, where space is not watched: for these links it is free unseen"
            )
        return self

    def build(self, beside: Path) -> Zone:
        """The zone.

        Args:
            beside: the site file's folder.

        Raises:
            MachineError: a box without an inside, or a mesh that is not usable or not convex.
            SiteError: a path that is none.
        """
        if self.mesh is not None:
            path = expand(self.mesh, beside)
            return Zone.from_mesh_file(self.name, self.kind, path, self.links, self.reason)
        assert self.lower_m is not None and self.upper_m is not None
        return Zone.box(self.name, self.kind, self.lower_m, self.upper_m, self.links, self.reason)


def with_zones(machine: Machine, entries: tuple[ZoneEntry, ...], beside: Path) -> Machine:
    """The machine with the zones of a site.

    Args:
        machine: without them.
        entries: as the file has them.
        beside: the site file's folder.

    Raises:
        SiteError, MachineError: as `ZoneEntry.build`; or a link that would not be watched anywhere.
    """
    zones = tuple(entry.build(beside) for entry in entries)
    machine = machine.with_zones(*zones)
    unwatched = [zone for zone in zones if zone.kind == "not_watched"]
    for some in (*([zone] for zone in unwatched), unwatched):
        covered = never_out_of(machine, [(zone.has, zone.names) for zone in some])
        if covered:
            names = [zone.name for zone in some if any(map(zone.names, covered))]
            them = "it" if len(names) == 1 else "them"
            raise SiteError(
                f"zones: {' and '.join(names)}: {', '.join(covered)} never leave {them}: nothing that they could "
                "hit would be watched for; make the zone smaller, or name these links in the machine's unchecked_links"
            )
    return machine
