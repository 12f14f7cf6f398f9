"""A room's things as a GLB, as `room.mesh` reads it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh

from elbowroom.files.atomic import whole_file
from elbowroom.simulate.solid import Solid

Y_UP_FROM_Z_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""glTF has y up."""


def write_room(solids: Sequence[Solid], path: Path) -> Path:
    """Writes solids where they stand, an object each, by their names.

    Args:
        solids: of the room.
        path: ends in .glb; a file of that name is replaced.

    Raises:
        InputError: the folder cannot be written to.
    """
    scene = trimesh.Scene()
    taken: set[str] = set()
    for solid in solids:
        name, number = solid.name, 2
        while name in taken:
            name, number = f"{solid.name} {number}", number + 1
        taken.add(name)
        mesh = trimesh.Trimesh(
            solid.vertices_in_world @ Y_UP_FROM_Z_UP[:3, :3].T, solid.mesh.faces, process=False
        )
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    content = scene.export(file_type="glb")
    assert isinstance(content, bytes)
    with whole_file(path) as unfinished:
        unfinished.write_bytes(content)
    return path
