"""A rigid part of the machine: a triangle mesh in a frame of its own."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A link and its collision geometry, possibly none.

    Args:
        name: unique in the machine.
        vertices: shape (n, 3), link frame [m].
        faces: shape (m, 3), indices into `vertices`; both sides of a triangle count.
    """

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def __post_init__(self) -> None:
        vertices = np.array(self.vertices, dtype=np.float64).reshape(-1, 3)
        faces = np.array(self.faces, dtype=np.int32).reshape(-1, 3)
        for name, array in (("vertices", vertices), ("faces", faces)):
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def has_geometry(self) -> bool:
        """Whether the link has any triangle."""
        return len(self.faces) > 0

    @property
    def triangles(self) -> NDArray[np.float64]:
        """Corners of the triangles, shape (m, 3, 3), link frame [m]."""
        return self.vertices[self.faces]
