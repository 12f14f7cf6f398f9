"""What a file of triangles holds: objects in their places, and what the file says of its unit and its axes."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Axis = Literal["x", "y", "z"]
Colour = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class MeshObject:
    """One object of a file, in the file's own frame and unit.

    Args:
        name: as the file has it; no other object of the file has it, too.
        vertices: where all transforms of the file put them, shape (n, 3), float64 [unit of the file].
        faces: shape (m, 3), indices of vertices, counter-clockwise from outside; turned where a transform mirrors.
        colour: of its first material, red, green, blue, linear, 0 to 1; None: the file says none.
    """

    name: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    colour: Colour | None = None


@dataclass(frozen=True, slots=True, eq=False)
class MeshFile:
    """A file of triangles.

    Args:
        objects: those with a surface, in the order of their names.
        up: the axis that points up, as the format or the file says; None: neither says it.
        unit_m: metres that one unit of the file is, as the format or the file says; None: neither says it.
        notes: what was left out because the file says so, or holds no surface; a sentence each.
    """

    objects: tuple[MeshObject, ...]
    up: Axis | None
    unit_m: float | None
    notes: tuple[str, ...] = ()


def named_apart(names: list[str]) -> list[str]:
    """The names, those that are there before with a number behind them."""
    given: set[str] = set()
    apart = []
    for name in names:
        number, own = 1, name
        while own in given:
            own, number = f"{name}_{number}", number + 1
        given.add(own)
        apart.append(own)
    return apart
