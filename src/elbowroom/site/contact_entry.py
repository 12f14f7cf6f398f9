"""What a machine may touch and what it carries, as a site file describes it."""

from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from elbowroom.machine import Machine, Part, Stand
from elbowroom.site.entry import Entry, Matrix, Point, Positive, Text
from elbowroom.site.paths import expand


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
