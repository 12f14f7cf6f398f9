"""A rigid solid in the room: a closed mesh and where it is."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

BOX_LEVELS = 4
"""A mesh's triangles are halved so many times to find its boxes."""


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Mesh:
    """Closed triangles; several closed parts may overlap. Shared by the solids that look alike.

    Two meshes are the same only if they are one object: caches of ray-casting scenes are kept by identity.

    Args:
        vertices: shape (n, 3), the solid's frame [m].
        faces: shape (m, 3), indices of vertices, counter-clockwise seen from outside.

    Attributes:
        boxes: up to 16 boxes that hold all triangles, least and greatest corners, shape (k, 2, 3) [m].
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    boxes: NDArray[np.float64] = field(init=False)

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=np.float64, order="C")
        faces = np.array(self.faces, dtype=np.int32, order="C")
        vertices.setflags(write=False)
        faces.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)
        boxes = np.array(_boxes(vertices[faces], BOX_LEVELS)) if len(faces) else np.zeros((0, 2, 3))
        boxes.setflags(write=False)
        object.__setattr__(self, "boxes", boxes)


def _boxes(triangles: NDArray[np.float64], levels: int) -> list[NDArray[np.float64]]:
    """Boxes about halves of the triangles, halved again, always along the longest side."""
    box = np.stack([triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))])
    if levels == 0 or len(triangles) < 16:
        return [box]
    middles = triangles.mean(axis=1)[:, np.argmax(box[1] - box[0])]
    order = np.argsort(middles, kind="stable")
    half = len(order) // 2
    return _boxes(triangles[order[:half]], levels - 1) + _boxes(triangles[order[half:]], levels - 1)


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A mesh at a place.

    Args:
        name: what it is, such as "doctor" or "table".
        mesh: its shape.
        world_from_solid: pose, shape (4, 4), rigid.
        is_machine: part of the machine that is supervised.
        is_static: never moves; such solids are the same objects in every moment of a room.
        is_dark: reflects little, so that a sensor often gets no return from it.
        colour: red, green, blue for pictures, 0 to 1, linear; None: grey.
        has_inside: False: a mesh that is not closed, or closed about the room itself: cameras may be within it.
    """

    name: str
    mesh: Mesh
    world_from_solid: NDArray[np.float64]
    is_machine: bool = False
    is_static: bool = False
    is_dark: bool = False
    colour: tuple[float, float, float] | None = None
    has_inside: bool = True

    def __post_init__(self) -> None:
        pose = np.array(self.world_from_solid, dtype=np.float64)
        pose.setflags(write=False)
        object.__setattr__(self, "world_from_solid", pose)

    @property
    def vertices_in_world(self) -> NDArray[np.float64]:
        """The mesh's vertices, shape (n, 3), world frame [m]."""
        return self.mesh.vertices @ self.world_from_solid[:3, :3].T + self.world_from_solid[:3, 3]


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """All that is in the room at one time.

    Args:
        time_s: time since the room's start [s].
        solids: everything solid, the machine's links among them.
        joints: the machine's joint positions by name [m or rad]; empty without a machine.
    """

    time_s: float
    solids: tuple[Solid, ...]
    joints: dict[str, float]

    @property
    def stamp_ns(self) -> int:
        """The moment's time in whole nanoseconds."""
        return round(self.time_s * 1e9)

    @property
    def static_solids(self) -> tuple[Solid, ...]:
        """What never moves."""
        return tuple(solid for solid in self.solids if solid.is_static)

    @property
    def moving_solids(self) -> tuple[Solid, ...]:
        """People and the machine."""
        return tuple(solid for solid in self.solids if not solid.is_static)
