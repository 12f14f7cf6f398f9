"""A part that a machine carries: a box, a cylinder or a mesh, on one of its links for as long as it is held."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from elbowroom.errors import MachineError
from elbowroom.machine.link import Surface
from elbowroom.machine.names import WILD


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """A part with a name and a surface in a frame of its own.

    Args:
        name: of the link that it becomes; no other link of the machine may have it.
        surface: its triangles.

    Raises:
        MachineError: no name, one with wildcards, or no triangles.
    """

    name: str
    surface: Surface

    def __post_init__(self) -> None:
        if not self.name:
            raise MachineError("part: has no name; verdicts name what meets a block")
        if set(self.name) & set(WILD):
            raise MachineError(
                f"part {self.name!r}: a name with {' or '.join(WILD)} would stand for other links; choose another one"
            )
        if not len(self.surface.faces) or not np.isfinite(self.surface.vertices).all():
            raise MachineError(f"part {self.name}: has no triangles with finite corners")

    @classmethod
    def box(cls, name: str, size_m: ArrayLike) -> Self:
        """A box about its frame's origin.

        Args:
            name: of the part.
            size_m: its edges, shape (3,) [m].

        Raises:
            MachineError: an edge that is not above 0.
        """
        sizes = np.asarray(size_m, dtype=float)
        if sizes.shape != (3,):
            raise MachineError(f"part {name}: size_m is {sizes.tolist()}, must be three edges [m]")
        return cls(name, _solid(name, "box", sizes.tolist()))

    @classmethod
    def cylinder(cls, name: str, radius_m: float, length_m: float) -> Self:
        """A cylinder about the z axis of its frame, its middle in the origin.

        Args:
            name: of the part.
            radius_m, length_m: its size [m].

        Raises:
            MachineError: a size that is not above 0.
        """
        return cls(name, _solid(name, "cylinder", [radius_m, length_m]))

    @classmethod
    def mesh(cls, name: str, path: str | Path, scale: float | Sequence[float] = 1.0) -> Self:
        """A mesh from a file.

        Args:
            name: of the part.
            path: of a kind that links may have.
            scale: from the file's unit to metres: 0.001 for millimetres; one number or three.

        Raises:
            MachineError: a file that is missing, unreadable or without triangles, or a scale that is not above 0.
        """
        # what reads meshes is slow to load, and most machines carry none
        from elbowroom.machine.mesh_file import read_mesh

        given = np.asarray(scale, dtype=float)
        if given.shape not in ((), (1,), (3,)) or not (np.isfinite(given).all() and (given > 0).all()):
            raise MachineError(f"part {name}: scale is {scale}, must be one number above 0 or three")
        if not Path(path).is_file():
            raise MachineError(f"part {name}: {path}: no such file; expected a mesh")
        read = read_mesh(Path(path))
        return cls(name, Surface(read.vertices * given, read.faces.astype(np.int32)))


def _solid(name: str, kind: Literal["box", "cylinder"], sizes: Sequence[float]) -> Surface:
    """The triangles of a solid of some sizes [m]."""
    from elbowroom.machine.meshes import solid_triangles

    if not (np.isfinite(sizes).all() and min(sizes) > 0):
        raise MachineError(f"part {name}: sizes {list(sizes)} must be finite and above 0 [m]")
    vertices, faces = solid_triangles(kind, sizes)
    return Surface(vertices, faces.astype(np.int32))
