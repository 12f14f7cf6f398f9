"""Triangles of a mesh file: STL, OBJ, PLY, GLB, glTF and Collada, in metres and axes of the file."""

import json
import struct
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.files.content import head_of, what_it_is
from elbowroom.geometry.solids import merged

MESH_SUFFIXES = (".stl", ".obj", ".glb", ".gltf", ".ply", ".dae")
"""Mesh files that can be read."""
MAX_MESH_BYTES = 500_000_000
"""A larger file is refused."""
_GLTF_MAY_REQUIRE = {
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "EXT_texture_webp",
}
"""Extensions of glTF that say nothing of where triangles lie, or that are read."""


class MeshFile(NamedTuple):
    """What a mesh file holds.

    Args:
        vertices: shape (n, 3) [m].
        faces: shape (m, 3).
        note: what a user should know of how it was read; "": nothing.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    note: str = ""


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
    if suffix == ".stl":
        count = _whole_stl(path)
        if count is not None:
            return _binary_stl(path, count)
    import trimesh  # slow to load, and binary STL does not need it

    if suffix == ".dae":
        from elbowroom.machine.collada import read_collada

        scene = read_collada(path)
        mesh = trimesh.Trimesh(scene.vertices, scene.faces)
        note = f"{path.name} says {scene.up_axis}" if scene.up_axis != "Z_UP" else ""
        return _checked(mesh, path, note)
    if suffix in (".glb", ".gltf"):
        _require_readable_gltf(path)
    try:
        loaded: object = trimesh.load(path, force="mesh")
    except Exception as error:  # trimesh's readers raise whatever their formats' parsers raise
        raise MachineError(f"mesh {path} cannot be read: {error}") from error
    read = _checked(loaded, path)
    _require_all(path)
    return read


def _whole_stl(path: Path) -> int | None:
    """How many triangles a binary STL holds; None: it is written in letters.

    Raises:
        MachineError: it is shorter or longer than it says: its reader would find other triangles, or none.
    """
    size, head = path.stat().st_size, head_of(path)
    count = int.from_bytes(head[80:84], "little")
    if b"\0" not in head:
        return count if size == 84 + 50 * count else None
    if size < 84:
        raise MachineError(f"mesh {path} has {size} bytes, fewer than the head of an STL")
    if size != 84 + 50 * count:
        holds = (size - 84) / 50
        raise MachineError(
            f"mesh {path} says that it has {count:,} triangles, and its {size:,} bytes hold {holds:,.1f}: "
            f"{'it was cut off' if holds < count else 'more follows, or its count was never written'}; export it anew"
        )
    return count


def _binary_stl(path: Path, count: int) -> MeshFile:
    """The triangles of a binary STL; corners at one place are one, in the order of the file, as trimesh takes them."""
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.fromfile(path, triangle, count, offset=84)["corners"].astype(np.float64)
    is_finite = np.isfinite(corners).all(axis=(1, 2))
    if count and not is_finite.all():
        lost = count - np.count_nonzero(is_finite)
        raise MachineError(f"mesh {path} has {lost} triangles with a corner that is no finite number")
    if not count:
        raise MachineError(f"mesh {path} holds no triangles with finite corners")
    vertices, faces = merged(corners.reshape(-1, 3))
    return MeshFile(vertices, faces.reshape(-1, 3))


def _checked(mesh: object, path: Path, note: str = "") -> MeshFile:
    import trimesh

    if not (isinstance(mesh, trimesh.Trimesh) and len(mesh.faces) and np.isfinite(mesh.vertices).all()):
        raise MachineError(f"mesh {path} holds no triangles with finite corners")
    return MeshFile(np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces), note)


def _require_all(path: Path) -> None:
    """Refuses a mesh of which corners are no numbers: its reader leaves out what hangs on them."""
    import trimesh

    raw: object = trimesh.load(path, process=False)
    parts = raw.geometry.values() if isinstance(raw, trimesh.Scene) else [raw]
    if not all(np.isfinite(part.vertices).all() for part in parts if isinstance(part, trimesh.Trimesh)):
        raise MachineError(f"mesh {path} has corners that are no finite numbers")


def _require_readable_gltf(path: Path) -> None:
    """Refuses what would move or pack triangles in ways that are not read here."""
    content = path.read_bytes()
    try:
        if content[:4] == b"glTF":
            (length,) = struct.unpack("<I", content[12:16])
            content = content[20 : 20 + length]
        document = json.loads(content)
        asked = set(document.get("extensionsRequired", ())) - _GLTF_MAY_REQUIRE
        skins = bool(document.get("skins"))
    except (struct.error, ValueError, AttributeError, TypeError) as error:
        raise MachineError(f"mesh {path} cannot be read: no glTF: {error}") from error
    if asked:
        raise MachineError(
            f"mesh {path} needs {', '.join(sorted(map(str, asked)))}, which is not read; export it without compression"
        )
    if skins:
        raise MachineError(f"mesh {path} bends by a skin, which is not read; export it as it stands")
