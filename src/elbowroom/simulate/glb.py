"""A room modelled by somebody, as solids: every object closed, or an error that names it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.objects import Axis
from elbowroom.simulate.closed import open_edge_count
from elbowroom.simulate.room_mesh import RoomMesh, RoomObject, read_room_mesh
from elbowroom.simulate.solid import Solid

GREY = (0.5, 0.5, 0.5)
DARK_LUMINANCE = 0.05
"""A surface that is darker reflects little of a sensor's light."""


def solids_of_glb(
    path: str | Path,
    *,
    up: Axis | None = None,
    unit_m: float | None = None,
    box_m: NDArray[np.float64] | None = None,
) -> tuple[Solid, ...]:
    """Reads the objects of a GLB file, or of another that `read_room_mesh` knows, as solids that never move.

    glTF has metres and y up; solids have metres and z up, as Blender shows them. Each object is one solid under its
    own name, with the colour of its first material; one darker than `DARK_LUMINANCE` is dark to sensors, too.

    Args:
        path: of the file.
        up, unit_m, box_m: as of `read_room_mesh`.

    Raises:
        InputError: missing, of no kind that can be read, empty, an object that is not closed or not in metres; one line
            that names the object and says what to do.
    """
    return solids_of(Path(path), read_room_mesh(path, up=up, unit_m=unit_m, box_m=box_m))


def solids_of(path: Path, room: RoomMesh) -> tuple[Solid, ...]:
    """The objects of a room as solids that never move.

    Raises:
        InputError: one is not closed; it is named.
    """
    return tuple(_solid(path, one) for one in room.objects)


def _solid(path: Path, one: RoomObject) -> Solid:
    if not one.is_closed:
        raise InputError(
            f"{path}: object {one.name!r} is not closed, {open_edge_count(one.mesh)} of its edges have a face on one "
            "side only; fill its holes or give it thickness (in Blender: Solidify, or Fill Holes), then export it again"
        )
    colour = one.colour or GREY
    dark = float(np.dot(colour, (0.2126, 0.7152, 0.0722))) < DARK_LUMINANCE
    return Solid(one.name, one.mesh, np.eye(4), is_static=True, is_dark=dark, colour=colour)
