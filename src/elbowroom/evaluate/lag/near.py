"""Boxes about a machine's links: who is far from all of them need not be asked how far."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine import Machine
from elbowroom.simulate import Solid


@dataclass(frozen=True, slots=True, eq=False)
class LinkBoxes:
    """Corners of the box about each checked link, in its frame.

    Args:
        machine: whose links.
        corners: by link, shape (8, 3) [m].
    """

    machine: Machine
    corners: Mapping[str, NDArray[np.float64]]

    @classmethod
    def of(cls, machine: Machine) -> Self:
        """The boxes of a machine's checked links."""
        found = {}
        for link in machine.links:
            if link.name in machine.checked_links:
                low, high = link.vertices.min(axis=0), link.vertices.max(axis=0)
                found[link.name] = np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
        return cls(machine, found)

    def may_be_near(self, joints: Mapping[str, float], solids: list[Solid], within_m: float) -> list[Solid]:
        """Those solids whose box comes near the box of any link, along the world's axes.

        Args:
            joints: where the machine is, by name [m or rad].
            solids: that are asked.
            within_m: what counts as near [m].
        """
        placed = self.machine.world_from_links(joints)
        boxes = [
            corners @ placed[name][:3, :3].T + placed[name][:3, 3] for name, corners in self.corners.items()
        ]
        near = []
        for solid in solids:
            points = solid.vertices_in_world
            low, high = points.min(axis=0) - within_m, points.max(axis=0) + within_m
            if any((box.max(axis=0) >= low).all() and (box.min(axis=0) <= high).all() for box in boxes):
                near.append(solid)
        return near
