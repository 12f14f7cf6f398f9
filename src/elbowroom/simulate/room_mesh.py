"""A room modelled by somebody, as all commands read it: objects in metres with z up, and what to say of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.files.mesh.objects import Axis, Colour, MeshFile, MeshObject
from elbowroom.files.mesh.read import read_mesh
from elbowroom.simulate.closed import merged_mesh, open_edge_count, signed_volume
from elbowroom.simulate.mesh_unit import require_size, unit_note
from elbowroom.simulate.solid import Mesh
from elbowroom.simulate.upright import upright_note

Array = NDArray[np.float64]
Z_UP_FROM: dict[Axis, Array] = {
    "x": np.array([[0.0, -1.0, 0], [0, 0, -1.0], [1.0, 0, 0]]),
    "y": np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]]),
    "z": np.eye(3),
}
"""Turns by the axis of a file that points up, as Collada defines them; glTF has y up."""
SHELL_SHARE = 0.5
"""An object whose faces point inwards and that holds so much of the whole is the shell of the room."""


@dataclass(frozen=True, slots=True, eq=False)
class RoomObject:
    """One object of a room.

    Args:
        name: as the file has it.
        mesh: world frame, z up [m].
        is_closed: each edge has as many faces on one side as on the other.
        is_shell: closed, and its faces point inwards, about the room.
        colour: linear, 0 to 1; None: the file says none.
    """

    name: str
    mesh: Mesh
    is_closed: bool
    is_shell: bool
    colour: Colour | None

    @property
    def is_solid(self) -> bool:
        """Whether it has an inside."""
        return self.is_closed and not self.is_shell


@dataclass(frozen=True, slots=True, eq=False)
class RoomMesh:
    """What a file says of a room.

    Args:
        objects: in the order of their names.
        notes: what a person should know of how the file was read, a line each.
    """

    objects: tuple[RoomObject, ...]
    notes: tuple[str, ...]


def read_room_mesh(
    path: str | Path, *, up: Axis | None = None, unit_m: float | None = None, box_m: Array | None = None
) -> RoomMesh:
    """Reads a room: units and axes obeyed, mirrored nodes turned, nothing dropped without a word.

    Args:
        path: of the file; see `READERS` for its kinds.
        up: the file's axis that points up; None: as the file or its format says, else z.
        unit_m: metres that one unit of the file is; None: as the file or its format says, else 1.
        box_m: the watched box, least and greatest corner, shape (2, 3), world frame [m]; None: not known.

    Raises:
        InputError: a file, a node or a mesh that cannot be read, no faces, corners that are not finite, or a size that
            no room has; one line that names the object and says what to do.
    """
    path = Path(path)
    file = read_mesh(path)
    if not file.objects:
        said = "".join(f"; {note}" for note in file.notes)
        raise InputError(f"{path}: holds no object with faces{said}; model closed solids and export them")
    chosen, metres = up or file.up or "z", unit_m or file.unit_m or 1.0
    placed = [_placed(path, one, Z_UP_FROM[chosen], metres) for one in file.objects]
    require_size(path, [(one.name, mesh) for one, mesh in placed], metres, box_m)
    objects, inward = _objects(placed)
    notes = [
        f"{path.name}: {note}" for note in (*file.notes, *_said(file, objects, inward, chosen, metres, box_m))
    ]
    return RoomMesh(tuple(objects), tuple(notes))


def _placed(path: Path, one: MeshObject, turn: Array, metres: float) -> tuple[MeshObject, Mesh]:
    if not np.isfinite(one.vertices).all():
        raise InputError(f"{path}: object {one.name!r} has corners that are not finite numbers; repair it")
    vertices = one.vertices if metres == 1.0 else one.vertices * metres
    # as glTF keeps them: one room is the same, to the bit, from every format and unit
    return one, merged_mesh((vertices @ turn.T).astype(np.float32).astype(np.float64), one.faces)


def _objects(placed: Sequence[tuple[MeshObject, Mesh]]) -> tuple[list[RoomObject], list[str]]:
    """Objects, those that are inside out turned but for the room's shell; names of what was turned."""
    corners = np.concatenate([mesh.vertices for _, mesh in placed])
    whole = float(np.prod(np.maximum(np.ptp(corners, axis=0), 1e-3)))
    objects, turned = [], []
    for one, mesh in placed:
        is_closed, is_shell = len(mesh.faces) > 0 and open_edge_count(mesh) == 0, False
        if is_closed and signed_volume(mesh) < 0:
            is_shell = float(np.prod(np.maximum(np.ptp(mesh.vertices, axis=0), 1e-3))) >= SHELL_SHARE * whole
            if not is_shell:
                mesh = Mesh(mesh.vertices, mesh.faces[:, ::-1])
                turned.append(one.name)
        objects.append(RoomObject(one.name, mesh, is_closed, is_shell, one.colour))
    return objects, turned


def _said(
    file: MeshFile,
    objects: Sequence[RoomObject],
    inward: Sequence[str],
    up: Axis,
    metres: float,
    box_m: Array | None,
) -> list[str]:
    notes = []
    if inward:
        notes.append(f"faces of {listed(inward)} point inwards; turned outwards")
    named = [(one.name, one.mesh) for one in objects]
    sides = upright_note(named, up)
    if sides is not None:
        notes.append(sides)
    size = None if box_m is None else unit_note(named, metres, box_m)
    if size is not None:
        notes.append(size)
    return notes


def listed(names: Sequence[str]) -> str:
    """Names for a message, the first five of them."""
    shown = ", ".join(repr(name) for name in names[:5])
    return shown + (f" and {len(names) - 5} more" if len(names) > 5 else "")
