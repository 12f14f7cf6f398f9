"""A rigid solid in the room: a closed mesh and where it is."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Mesh:
    """Closed triangles; several closed parts may overlap. Shared by the solids that look alike.

    Two meshes are the same only if they are one object: caches of ray-casting scenes are kept by identity.

    Args:
        vertices: shape (n, 3), the solid's frame [m].
        faces: shape (m, 3), indices of vertices, counter-clockwise seen from outside.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=np.float64, order="C")
        faces = np.array(self.faces, dtype=np.int32, order="C")
        vertices.setflags(write=False)
        faces.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Least and greatest corner, shape (2, 3), the solid's frame [m]."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])


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
    """

    name: str
    mesh: Mesh
    world_from_solid: NDArray[np.float64]
    is_machine: bool = False
    is_static: bool = False
    is_dark: bool = False

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
