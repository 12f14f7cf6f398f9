"""What a machine stands on: a box of the room that some of its links may touch."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError
from elbowroom.machine.names import is_named

ROUNDING_IN_VOXELS = 1e-6
"""Corners of voxels may stand out of a box by this much and lie in it."""


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """A box that stands still, whose blocked voxels do not end the travel of some links: a table, a floor, a pillar.

    It frees no voxel: all other links stop there. These links are not stopped there by anything, so neither by a hand.

    Args:
        links: names of the links that may touch it; they may hold wildcards ("*").
        lower_m, upper_m: its corners, shape (3,), world frame [m].

    Raises:
        MachineError: no link, or a box without extent.
    """

    links: tuple[str, ...]
    lower_m: NDArray[np.float64]
    upper_m: NDArray[np.float64]

    def __post_init__(self) -> None:
        object.__setattr__(self, "links", tuple(self.links))
        for name in ("lower_m", "upper_m"):
            corner = np.array(getattr(self, name), dtype=np.float64)
            if corner.shape != (3,) or not np.isfinite(corner).all():
                raise MachineError(
                    f"stands_on: {name} is {corner.tolist()}, must be three finite numbers [m]"
                )
            corner.setflags(write=False)
            object.__setattr__(self, name, corner)
        if not self.links:
            raise MachineError("stands_on: no links; name those that may touch the box")
        if not (self.lower_m < self.upper_m).all():
            raise MachineError(
                f"stands_on: the box from {self.lower_m.tolist()} to {self.upper_m.tolist()} m has no inside; "
                "lower_m is its least corner, upper_m its greatest"
            )

    @classmethod
    def box(cls, links: Sequence[str], lower_m: ArrayLike, upper_m: ArrayLike) -> Self:
        """As the class, from anything that is like arrays.

        Args:
            links: names of the links that may touch it.
            lower_m, upper_m: its corners, shape (3,), world frame [m].

        Raises:
            MachineError: as the class.
        """
        return cls(tuple(links), np.asarray(lower_m, dtype=float), np.asarray(upper_m, dtype=float))

    def names(self, link: str) -> bool:
        """Whether a link may touch it; names may hold wildcards ("*")."""
        return any(is_named(link, name) for name in self.links)

    def __str__(self) -> str:
        corners = " to ".join(
            "(" + ", ".join(f"{value:g}" for value in corner) + ")" for corner in (self.lower_m, self.upper_m)
        )
        return f"{', '.join(self.links)} in {corners} m"
