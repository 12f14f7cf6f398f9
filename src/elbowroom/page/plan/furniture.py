"""Things to place: furniture of the package, boxes, and whatever a file brings."""

import tempfile
from pathlib import Path

import numpy as np

from elbowroom.errors import InputError
from elbowroom.page.plan.layout import PlacedThing
from elbowroom.simulate.furniture import furniture
from elbowroom.simulate.room_mesh import read_room_mesh
from elbowroom.simulate.shapes import box, join
from elbowroom.simulate.solid import Mesh, Solid

MOST_BYTES, MOST_TRIANGLES = 30_000_000, 300_000
"""A file that is larger is not placed; simplify it first."""
ENDINGS = (".glb", ".gltf", ".obj", ".ply", ".stl", ".off", ".dae")
LARGEST_M, SMALLEST_M = 20.0, 0.01
"""A thing that is longer, or shorter, was not modelled in metres [m]."""
BOXES_M: dict[str, tuple[float, float, float]] = {
    "box": (0.6, 0.6, 0.8),
    "cabinet": (0.9, 0.45, 1.9),
    "partition": (1.6, 0.06, 1.9),
    "desk": (1.6, 0.8, 0.75),
}
"""Plain boxes: length, width, height [m]."""
PACKAGE = ("table", "monitors", "lamp")
"""Furniture of the simulated room."""


def kinds() -> tuple[str, ...]:
    """What can be placed by name."""
    return (*BOXES_M, *PACKAGE)


def thing_of(kind: str, name: str) -> PlacedThing:
    """A thing of the package, its origin below its middle.

    Args:
        kind: one of `kinds`.
        name: of this one.

    Raises:
        InputError: no such kind.
    """
    if kind in BOXES_M:
        length, width, height = BOXES_M[kind]
        shape = box((-length / 2, -width / 2, 0.0), (length / 2, width / 2, height))
        return PlacedThing(name, kind, (Solid(name, join([shape]), np.eye(4), is_static=True),))
    for solid in furniture():
        if solid.name == kind:
            return _stood(name, kind, [solid])
    raise InputError(f"thing: {kind!r} is unknown, known are {', '.join(kinds())}")


def thing_of_file(file_name: str, content: bytes, name: str) -> PlacedThing:
    """What a file holds, as one thing.

    Args:
        file_name: by whose ending it is read.
        content: of the file.
        name: of this one.

    Raises:
        InputError: too large, another kind of file, or broken; the message says which, and names the file alone.
    """
    ending = Path(file_name).suffix.lower()
    if ending not in ENDINGS:
        raise InputError(f"{file_name}: no mesh that can be read; allowed are {', '.join(ENDINGS)}")
    if len(content) > MOST_BYTES:
        raise InputError(
            f"{file_name}: {len(content) / 1e6:.0f} MB, at most {MOST_BYTES / 1e6:.0f} MB; simplify it first"
        )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"file{ending}"
        path.write_bytes(content)
        try:
            room = read_room_mesh(path)
        except InputError as error:
            raise InputError(str(error).replace(str(path), file_name).replace(path.name, file_name)) from None
    triangles = sum(len(one.mesh.faces) for one in room.objects)
    if triangles > MOST_TRIANGLES:
        raise InputError(
            f"{file_name}: {triangles:,} triangles, at most {MOST_TRIANGLES:,}; simplify it first"
        )
    solids = [
        Solid(one.name, one.mesh, np.eye(4), is_static=True, has_inside=one.is_solid) for one in room.objects
    ]
    thing = _stood(name, file_name, solids)
    corners = np.concatenate([part.mesh.vertices for part in thing.parts])
    longest = float(np.ptp(corners, axis=0).max())
    if longest > LARGEST_M:
        raise InputError(f"{file_name}: {longest:.0f} m long; export it in metres")
    if longest < SMALLEST_M:
        raise InputError(f"{file_name}: {1e3 * longest:.2g} mm long; export it in metres")
    return thing


def _stood(name: str, kind: str, solids: list[Solid]) -> PlacedThing:
    """Solids about an origin below their middle; the thing stands where they stood."""
    corners = np.concatenate([solid.vertices_in_world for solid in solids])
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    origin = np.array([*((lower + upper) / 2)[:2], lower[2]])
    parts = tuple(
        Solid(
            solid.name,
            Mesh(solid.vertices_in_world - origin, solid.mesh.faces),
            np.eye(4),
            is_static=True,
            is_dark=solid.is_dark,
            has_inside=solid.has_inside,
        )
        for solid in solids
    )
    return PlacedThing(name, kind, parts, float(origin[0]), float(origin[1]), float(origin[2]))
