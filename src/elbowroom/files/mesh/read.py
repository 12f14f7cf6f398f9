"""One reader for all files of triangles, by their ending."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from elbowroom.errors import InputError
from elbowroom.files.mesh.collada import read_collada
from elbowroom.files.mesh.gltf_scene import read_gltf
from elbowroom.files.mesh.objects import MeshFile, MeshObject
from elbowroom.files.mesh.ply import read_ply
from elbowroom.files.mesh.stl import read_stl
from elbowroom.files.mesh.wavefront import read_wavefront


def read_mesh(path: str | Path) -> MeshFile:
    """The objects of a file, each where the file puts it.

    Raises:
        InputError: no such file, of an unknown kind, or something of it that cannot be read; one line that names it.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected one of {', '.join(READERS)}")
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"{path}: files of kind {path.suffix!r} cannot be read, those of {', '.join(READERS)} can"
        )
    return reader(path)


def read_off(path: Path) -> MeshFile:
    """The one object of an .off file, in its own unit.

    Raises:
        InputError: damaged.
    """
    import trimesh

    try:
        scene = trimesh.load_scene(path, process=False)
        objects = [
            MeshObject(
                path.stem, np.array(shape.vertices, dtype=np.float64), np.array(shape.faces, dtype=np.int64)
            )
            for shape in scene.geometry.values()
            if len(shape.faces)
        ]
    except Exception as error:  # whatever a damaged file makes the reader stumble over
        said = " ".join(str(error).split())
        raise InputError(
            f"{path}: cannot be read ({type(error).__name__}: {said}); export it again"
        ) from error
    return MeshFile(tuple(objects), None, None)


READERS: Mapping[str, Callable[[Path], MeshFile]] = {
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".dae": read_collada,
    ".obj": read_wavefront,
    ".ply": read_ply,
    ".stl": read_stl,
    ".off": read_off,
}
"""By ending of the file's name."""
