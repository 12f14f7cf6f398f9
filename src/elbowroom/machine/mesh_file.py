"""Triangles of a mesh file: STL, OBJ, PLY, GLB, glTF and Collada, in metres and axes of the file."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError, MachineError
from elbowroom.files.content import head_of, what_it_is
from elbowroom.files.mesh import read as mesh
from elbowroom.files.mesh.gltf_file import gltf_file
from elbowroom.geometry.solids import Triangles, merged

MESH_SUFFIXES = (".stl", ".obj", ".glb", ".gltf", ".ply", ".dae")
"""Mesh files that can be read."""
MAX_MESH_BYTES = 500_000_000
"""A larger file is refused."""


class MeshFile(NamedTuple):
    """What a mesh file holds.

    Args:
        vertices: shape (n, 3) [m].
        faces: shape (m, 3).
        note: what the file says of its axes, which are taken as they stand; "": nothing, or that z is up.
        notes: what was left out because the file says so, or holds no surface; a sentence each.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    note: str = ""
    notes: tuple[str, ...] = ()


def read_mesh(path: Path) -> MeshFile:
    """All triangles of a file, where its own scene puts them.

    Raises:
        MachineError: a file of an unknown kind, one that cannot be read, that holds no triangles, or of which a part
            would be lost.
    """
    suffix = path.suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise MachineError(f"mesh {path} is of an unknown kind; allowed are {', '.join(MESH_SUFFIXES)}")
    size = path.stat().st_size
    if size > MAX_MESH_BYTES:
        raise MachineError(f"mesh {path} has {size:,} bytes; at most {MAX_MESH_BYTES:,} are read")
    found = what_it_is(head_of(path))
    if found:
        raise MachineError(f"mesh {path} is {found}")
    if suffix == ".dae":
        from elbowroom.machine.collada import read_collada

        scene = read_collada(path)
        note = f"{path.name} says {scene.up_axis}" if scene.up_axis != "Z_UP" else ""
        return _joined(path, [(scene.vertices, scene.faces)], note, ())
    try:
        if suffix in (".glb", ".gltf") and gltf_file(path).listed("skins"):
            raise MachineError(f"mesh {path} bends by a skin, which is not read; export it as it stands")
        file = mesh.read_mesh(path)
    except InputError as error:
        raise MachineError(f"mesh {error}") from error
    return _joined(path, [(one.vertices, one.faces) for one in file.objects], "", file.notes)


def _joined(path: Path, parts: Sequence[Triangles], note: str, notes: tuple[str, ...]) -> MeshFile:
    """Triangles of all parts as one surface: corners at one place are one, in the order of the file."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    vertices = np.concatenate([np.zeros((0, 3)), *(vertices for vertices, _ in parts)])
    faces = np.concatenate(
        [np.zeros((0, 3), dtype=np.int64), *(faces + n for (_, faces), n in zip(parts, starts, strict=False))]
    )
    is_used = np.zeros(len(vertices), dtype=bool)
    is_used[faces] = True
    is_finite = np.isfinite(vertices).all(axis=1)
    if not is_finite[is_used].all():
        lost = np.count_nonzero(~is_finite[faces].all(axis=1))
        raise MachineError(f"mesh {path} has {lost} triangles with a corner that is no finite number")
    if not len(faces):
        raise MachineError("; ".join((f"mesh {path} holds no triangles", *notes)))
    places, number = merged(vertices[is_used])
    return MeshFile(places, number[np.cumsum(is_used) - 1][faces], note, notes)
