"""What cameras see of a link: its visual geometry, where that is what its collision geometry was laid around.

Collision geometry is often larger than the machine: convex hulls, capsules, boxes. A motion is swept with it, but what
cameras measure lies within it, and so does a hand in the opening of a C. The two can only be told apart by the surface
that is really there.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.description.shapes import Shape
from elbowroom.machine.link import Surface

OUTSIDE_M = 0.01
"""Visual geometry that stands out of the collision geometry by more is a picture of something else, or what collides is
drawn too small: then the collision geometry explains, and what stands out stops the machine [m]."""
SHORT_M, SHORT = 0.1, 0.25
"""Visual geometry that stays inside the box about the collision geometry by more on any side, as a length [m] and as a
share of the box's edge, is a picture of a part of the link."""


def are_the_same(some: Sequence[Shape], others: Sequence[Shape]) -> bool:
    """Whether shapes are others, one by one, so that they need not be read again."""
    return sorted(map(_key, some)) == sorted(map(_key, others))


def together(pieces: Sequence[Surface]) -> Surface:
    """Several surfaces of a link as one."""
    firsts = np.cumsum([0] + [len(piece.vertices) for piece in pieces])
    return Surface(
        np.concatenate([np.zeros((0, 3)), *(piece.vertices for piece in pieces)]),
        np.concatenate(
            [
                np.zeros((0, 3), dtype=np.int64),
                *(piece.faces + first for piece, first in zip(pieces, firsts, strict=False)),
            ]
        ),
    )


class Fit(NamedTuple):
    """How visual geometry lies in the collision geometry of its link.

    Args:
        fills: whether it reaches about as far, on each side; none at all does not.
        outside_m: how far it stands out, at most [m].
    """

    fills: bool
    outside_m: float

    @property
    def is_seen(self) -> bool:
        """Whether it is what cameras see of the link, as far as that can be told."""
        return self.fills and self.outside_m <= OUTSIDE_M

    @property
    def is_larger(self) -> bool:
        """Whether it is a picture of the link, and the link is swept with less."""
        return self.fills and self.outside_m > OUTSIDE_M


def fit_of(visual: Surface, collision: Surface, shapes: Sequence[NDArray[np.float64]]) -> Fit:
    """How visual geometry lies in the collision geometry of its link.

    Args:
        visual, collision: of the link.
        shapes: vertices of each collision shape, shape (n, 3), link frame [m].
    """
    if not len(visual.faces):
        return Fit(False, 0.0)
    return Fit(_fills(visual, collision), outside(visual, shapes))


def outside(visual: Surface, shapes: Sequence[NDArray[np.float64]]) -> float:
    """How far a surface stands out of the convex hulls of some shapes, at most [m].

    Args:
        visual: the surface.
        shapes: vertices of each shape, shape (n, 3), the same frame [m].
    """
    return float(np.min([_beyond(visual.vertices, shape) for shape in shapes], axis=0).max(initial=0.0))


def _beyond(points: NDArray[np.float64], shape: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far points lie beyond the faces of the convex hull of a shape, or if it is flat, of the box about it [m]."""
    from scipy.spatial import ConvexHull, QhullError  # slow to load, and few machines need it

    try:
        planes = ConvexHull(shape).equations
    except QhullError:
        planes = np.vstack(
            [
                np.column_stack([np.eye(3), -shape.max(axis=0)]),
                np.column_stack([-np.eye(3), shape.min(axis=0)]),
            ]
        )
    beyond = np.full(len(points), -np.inf)
    for plane in planes:
        np.maximum(beyond, points @ plane[:3] + plane[3], out=beyond)
    return beyond


def _fills(visual: Surface, collision: Surface) -> bool:
    """Whether a surface reaches, side by side, about as far as the box about another."""
    lower, upper = collision.vertices.min(axis=0), collision.vertices.max(axis=0)
    short = np.maximum(SHORT_M, SHORT * (upper - lower))
    seen = visual.vertices[np.unique(visual.faces)]
    return bool((seen.min(axis=0) <= lower + short).all() and (seen.max(axis=0) >= upper - short).all())


def _key(shape: Shape) -> str:
    """All that a shape is, in a line: the same for shapes that are the same."""
    return repr((shape.kind, shape.sizes, shape.filename, shape.scale, shape.link_from_shape.tolist()))
