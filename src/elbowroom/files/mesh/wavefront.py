"""Wavefront (.obj): its objects, or its groups where it names no objects; it has no unit and says no axis."""

from pathlib import Path

import numpy as np

from elbowroom.errors import InputError
from elbowroom.files.mesh.objects import MeshFile, MeshObject
from elbowroom.files.mesh.polygons import triangles_of

CURVED = ("curv", "curv2", "surf", "cstype")
"""Statements of curved surfaces."""


def read_wavefront(path: Path) -> MeshFile:
    """The objects of a file, in its own unit.

    Raises:
        InputError: a line that cannot be read, or curved surfaces; names the line.
    """
    vertices: list[tuple[float, float, float]] = []
    by_object: dict[str, list[list[int]]] = {}
    by_group: dict[str, list[list[int]]] = {}
    thing, group, polygon = "", "", [0]
    latest = (0, 0, "")
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ").replace("\\\r\n", " ")
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        if not words:
            continue
        try:
            if words[0] == "v":
                vertices.append((float(words[1]), float(words[2]), float(words[3])))
            elif words[0] in ("f", "fo"):
                polygon = [_index(word, len(vertices)) for word in words[1:]]
                latest = max(latest, (max(polygon, default=0), number, line.strip()))
                by_object.setdefault(thing, []).append(polygon)
                by_group.setdefault(group, []).append(polygon)
        except (ValueError, IndexError) as error:
            raise InputError(
                f"{path}: line {number}: {line.strip()[:60]!r} cannot be read ({error})"
            ) from None
        if words[0] == "o":
            thing = " ".join(words[1:])
        elif words[0] == "g":
            group = " ".join(words[1:])
        elif words[0] in CURVED:
            raise InputError(f"{path}: line {number}: curved surfaces ({words[0]}); export it as triangles")
    if latest[0] >= len(vertices) and latest[1]:
        raise InputError(
            f"{path}: line {latest[1]}: {latest[2][:60]!r} cannot be read (vertex {latest[0] + 1} of {len(vertices)})"
        )
    parts = by_object if set(by_object) != {""} else by_group
    places = np.array(vertices, dtype=np.float64).reshape(-1, 3)
    objects = []
    for name, polygons in parts.items():
        faces = triangles_of(places, polygons)
        used, faces = np.unique(faces, return_inverse=True)
        if len(used):
            objects.append(MeshObject(name or path.stem, places[used], faces.reshape(-1, 3)))
    return MeshFile(tuple(sorted(objects, key=lambda one: one.name)), None, None)


def _index(word: str, count: int) -> int:
    """Of a vertex, from 0; in the file from 1, it may come later, or below 0 from the last one before."""
    given = int(word.split("/", 1)[0])
    index = given - 1 if given > 0 else count + given
    if given == 0 or index < 0:
        raise ValueError(f"vertex {given} of {count}")
    return index
