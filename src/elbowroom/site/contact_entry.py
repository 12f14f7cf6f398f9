"""What a machine may touch and what it carries, as a site file describes it."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from elbowroom.errors import SiteError
from elbowroom.machine import Contact, Machine, Part, Stand, Zone
from elbowroom.machine.contact import NEAR_M
from elbowroom.machine.ways import Inside, Names, never_out_of
from elbowroom.site.entry import Entry, Flag, Matrix, Point, Positive, Text
from elbowroom.site.paths import expand
from elbowroom.site.ranges import MILLIMETRES, up_to


class StandEntry(Entry):
    """A box of the room that some links may touch: what the machine stands on."""

    links: Annotated[tuple[Text, ...], Field(min_length=1)]
    lower_m: Point
    upper_m: Point

    def build(self) -> Stand:
        """The box.

        Raises:
            MachineError: it has no inside.
        """
        return Stand.box(self.links, self.lower_m, self.upper_m)


class ZoneOfContact(Entry):
    """The box in which links may be near a thing."""

    lower_m: Point
    upper_m: Point


class ContactEntry(Entry):
    """A fixed thing of the room that some links may be near: a box, or a mesh at a place."""

    name: Text
    links: Annotated[tuple[Text, ...], Field(min_length=1)]
    lower_m: Point | None = None
    upper_m: Point | None = None
    mesh: Text | None = None
    world_from_mesh: Matrix | None = None
    near_m: Annotated[Positive, up_to(1.0, "m", MILLIMETRES)] = NEAR_M
    zone: ZoneOfContact | None = None
    may_touch: Flag = False

    @model_validator(mode="after")
    def _one_shape(self) -> "ContactEntry":
        box = self.lower_m is not None and self.upper_m is not None
        if (self.lower_m is None) != (self.upper_m is None) or box == (self.mesh is not None):
            raise ValueError("either lower_m and upper_m, or mesh")
        if self.world_from_mesh is not None and self.mesh is None:
            raise ValueError("world_from_mesh only with mesh")
        return self

    def build(self, beside: Path) -> Contact:
        """The contact.

        Args:
            beside: the site file's folder.

        Raises:
            MachineError: a box without an inside, a zone without one, or a mesh that is not usable.
            SiteError: a path that is none.
        """
        zone = None if self.zone is None else np.array([self.zone.lower_m, self.zone.upper_m])
        if self.mesh is None:
            assert self.lower_m is not None and self.upper_m is not None
            made = Contact.box(self.name, self.links, self.lower_m, self.upper_m)
        else:
            made = Contact.from_mesh_file(
                self.name, self.links, expand(self.mesh, beside), self.world_from_mesh
            )
        return replace(made, near_m=self.near_m, zone=zone, may_touch=self.may_touch)


def require_protected(machine: Machine) -> None:
    """Refuses contacts and stands that a moving link never leaves, one alone or several together.

    Args:
        machine: with what it may touch.

    Raises:
        SiteError: there is one; says what would be unprotected.
    """
    near = [(contact.name, contact.is_near, contact.names) for contact in machine.contacts]
    for name, covered in _covering(machine, near):
        raise SiteError(
            f"contacts: {name} the whole way of {covered}: wherever these links go, what lies close to it would be "
            "taken for it; name fewer links, a smaller near_m or a zone"
        )
    stands = [
        (str(stand), Zone.box("stand", "kept_out", stand.lower_m, stand.upper_m).has, stand.names)
        for stand in machine.stands
    ]
    for name, covered in _covering(machine, stands):
        raise SiteError(
            f"stands_on: {name} the whole way of {covered}: wherever these links go, nothing would stop them, a hand "
            "neither; name fewer links or a smaller box"
        )


def _covering(machine: Machine, volumes: Sequence[tuple[str, Inside, Names]]) -> Iterator[tuple[str, str]]:
    """Which of some volumes cover the whole way of which links, one alone and then all together, in words."""
    for some in (*([volume] for volume in volumes), volumes):
        covered = never_out_of(machine, [(inside, names) for _, inside, names in some])
        if covered:
            which = [name for name, _, names in some if any(map(names, covered))]
            yield " and ".join(which) + (": covers" if len(which) == 1 else ": cover"), ", ".join(covered)


class PartEntry(Entry):
    """A part on a link: a box, a cylinder about its z axis, or a mesh."""

    name: Text
    link: Text
    box_m: Point | None = None
    cylinder_m: tuple[Positive, Positive] | None = None
    mesh: Text | None = None
    mesh_scale: Positive | None = None
    link_from_part: Matrix | None = None

    @model_validator(mode="after")
    def _one_shape(self) -> "PartEntry":
        if sum(shape is not None for shape in (self.box_m, self.cylinder_m, self.mesh)) != 1:
            raise ValueError("exactly one of box_m, cylinder_m (radius, length) and mesh")
        if self.mesh_scale is not None and self.mesh is None:
            raise ValueError("mesh_scale only with mesh")
        return self

    def on(self, machine: Machine, beside: Path) -> Machine:
        """The machine with this part.

        Args:
            machine: without it.
            beside: the site file's folder.

        Raises:
            MachineError: no such link, or a part that none can be.
        """
        pose = None if self.link_from_part is None else np.array(self.link_from_part)
        return machine.with_part(self.link, self._part(beside), pose)

    def _part(self, beside: Path) -> Part:
        if self.box_m is not None:
            return Part.box(self.name, self.box_m)
        if self.cylinder_m is not None:
            return Part.cylinder(self.name, *self.cylinder_m)
        return Part.mesh(self.name, expand(str(self.mesh), beside), self.mesh_scale or 1.0)
