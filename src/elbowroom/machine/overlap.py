"""Which links touch in many poses, by their triangles."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.boxes import boxes_of
from elbowroom.machine.kernels.apart import Bodies, apart_now
from elbowroom.machine.link import Link
from elbowroom.machine.shape import Shape

POSES, ALWAYS = 40, 0.95
"""Links that touch in this share of so many poses, drawn from the joints' limits, always do."""
MET_M = 5e-4
"""Links that are as near as this have met [m]."""
TOUCH_M = 1e-6
"""Links touch that are no farther apart than this: rounding [m]."""


def bodies_of(shape: Shape, rows: Sequence[tuple[int, int]]) -> Bodies:
    """Pairs of links as triangles.

    Args:
        shape: the links.
        rows: of the links of each pair.
    """
    one, other = np.array(rows, dtype=np.int64).reshape(-1, 2).T
    return Bodies(boxes_of(shape), np.ascontiguousarray(one), np.ascontiguousarray(other), MET_M)


def touching(bodies: Bodies, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether pairs of links touch, shape (n, pairs).

    Args:
        bodies: the pairs.
        poses: where links are, shape (n, n_links, 4, 4).
    """
    apart = np.empty((len(poses), len(bodies.one)))
    for placed, away in zip(poses, apart, strict=True):
        apart_now(bodies, placed, 2 * TOUCH_M, away)
    return apart <= TOUCH_M


def always_touching(
    shape: Shape, rows: Sequence[tuple[int, int]], poses: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Of pairs of links, those that touch in nearly all poses, shape (pairs,).

    Args:
        shape: the links.
        rows: of the links of each pair.
        poses: where links are, shape (n, n_links, 4, 4).
    """
    return np.asarray(touching(bodies_of(shape, rows), poses).mean(axis=0) >= ALWAYS)


def is_within(one: Link, other: Link, other_from_one: NDArray[np.float64]) -> bool:
    """Whether a link whose surface does not touch another's lies wholly in it.

    By the solid angle that the other takes as seen from one of its points (van Oosterom, Strackee 1983).

    Args:
        one, other: links; the other is closed.
        other_from_one: pose, shape (4, 4).
    """
    point = other_from_one[:3, :3] @ one.vertices[one.faces[0, 0]] + other_from_one[:3, 3]
    a, b, c = np.moveaxis(other.triangles - point, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    above = (a * np.cross(b, c)).sum(axis=1)
    below = la * lb * lc + (a * b).sum(axis=1) * lc + (a * c).sum(axis=1) * lb + (b * c).sum(axis=1) * la
    return bool(abs(2 * np.arctan2(above, below).sum()) > 2 * np.pi)
