"""A rigid part of the machine: a triangle mesh in a frame of its own."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles in the frame of a link, possibly none.

    Args:
        vertices: shape (n, 3), link frame [m].
        faces: shape (m, 3), indices into `vertices`; both sides of a triangle count.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=np.float64).reshape(-1, 3)
        faces = np.array(self.faces, dtype=np.int32).reshape(-1, 3)
        for name, array in (("vertices", vertices), ("faces", faces)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Link:
    """A link and its collision geometry, possibly none.

    Args:
        name: unique in the machine.
        vertices: shape (n, 3), link frame [m].
        faces: shape (m, 3), indices into `vertices`; both sides of a triangle count.
        seen: the link with what cameras see of it for a body, where that is less than its collision geometry
            (`machine.seen`); None: the same.
    """

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    seen: Self | None = None

    def __post_init__(self) -> None:
        surface = Surface(self.vertices, self.faces)
        object.__setattr__(self, "vertices", surface.vertices)
        object.__setattr__(self, "faces", surface.faces)

    @property
    def has_geometry(self) -> bool:
        """Whether the link has any triangle."""
        return len(self.faces) > 0

    @property
    def triangles(self) -> NDArray[np.float64]:
        """Corners of the triangles, shape (m, 3, 3), link frame [m]."""
        return self.vertices[self.faces]

    @property
    def as_seen(self) -> Self:
        """The link with what cameras see of it for a body."""
        return self if self.seen is None else self.seen
