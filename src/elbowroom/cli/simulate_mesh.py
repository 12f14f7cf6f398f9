"""The room that `elbowroom simulate --room` names: a file, or one of the package."""

import os
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.files.mesh.objects import Axis
from elbowroom.geometry import VoxelGrid
from elbowroom.placement.fixed_room import SETUP_NAMES
from elbowroom.simulate import Solid, setup
from elbowroom.simulate.glb import solids_of
from elbowroom.simulate.room_mesh import read_room_mesh


@dataclass(frozen=True, slots=True)
class RoomFile:
    """What the command line says of the room.

    Args:
        name: of a file, or "setup1" to "setup6".
        up, unit_m: of the file, as of `read_room_mesh`; None: as it says.
    """

    name: str
    up: Axis | None = None
    unit_m: float | None = None

    @property
    def is_shipped(self) -> bool:
        """Whether it is a room of the package."""
        return self.name in SETUP_NAMES

    def solids(self, box: VoxelGrid) -> tuple[Solid, ...]:
        """Its closed objects; notes about the file go to stderr.

        Args:
            box: the watched box, which tells a unit that cannot be.

        Raises:
            InputError: as `read_room_mesh` and `solids_of`.
        """
        if self.is_shipped:
            return setup(self.name).solids()
        box_m = np.array([box.lower_m, box.upper_m])
        room = read_room_mesh(self.name, up=self.up, unit_m=self.unit_m, box_m=box_m)
        for note in room.notes:
            print(f"note: {note}", file=sys.stderr)
        return solids_of(Path(self.name), room)

    def entry(self, beside: Path) -> dict[str, Any]:
        """The key `room` of a site file.

        Args:
            beside: the site file's folder.
        """
        if self.is_shipped:
            return {"mesh": self.name}
        said = {
            "mesh": os.path.relpath(Path(self.name).absolute(), beside.absolute()),
            "mesh_up": self.up,
            "mesh_unit_m": self.unit_m,
        }
        return {key: value for key, value in said.items() if value is not None}
