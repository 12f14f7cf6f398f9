"""A movable joint: which link it carries, along or about which axis, how far."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

JointKind = Literal["prismatic", "revolute", "continuous"]
Unit = Literal["m", "rad"]
"""Of positions: of joints that slide, and of those that turn."""


@dataclass(frozen=True, slots=True)
class Mimic:
    """A joint that follows another one: position = multiplier * position of `joint` + offset.

    Args:
        joint: name of the joint that leads.
        multiplier: without unit, or [m/rad], [rad/m] where the kinds differ.
        offset: [m or rad].
    """

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """A joint that moves.

    Args:
        name: unique in the machine.
        kind: "prismatic" (slides, [m]), "revolute" or "continuous" (turns, [rad]).
        parent, child: names of the links that it connects.
        axis_in_joint: unit vector, shape (3,), in the joint's frame, which is the child's at position zero.
        parent_from_joint: shape (4, 4), rigid.
        lower, upper: limits [m or rad]; minus and plus infinity for a continuous joint.
        mimic: the joint that this one follows; None: it is commanded itself.
        is_posed: whether it is a part of a floating joint: it has a position, but nobody commands it.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    axis_in_joint: NDArray[np.float64]
    parent_from_joint: NDArray[np.float64]
    lower: float
    upper: float
    mimic: Mimic | None = None
    is_posed: bool = False

    def __post_init__(self) -> None:
        for name in ("axis_in_joint", "parent_from_joint"):
            array = np.array(getattr(self, name), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def unit(self) -> Unit:
        """ "m" for a joint that slides, "rad" for one that turns."""
        return "m" if self.kind == "prismatic" else "rad"
