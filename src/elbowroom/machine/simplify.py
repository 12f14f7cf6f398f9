"""Fine meshes with as few triangles as a voxel or a pixel can tell from all of them."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.machine.kernels.simplify import Fans, Marks, Surface, list_fans, thin
from elbowroom.machine.link import Link

BOUNDS_M = (0.000125, 0.00025, 0.0005, 0.001, 0.002)
"""How far the surfaces of the coarser links may lie from the link's own, each made from the one before [m]."""
FEW_TRIANGLES = 64
"""A link of so few stays as it is."""
MOST_ROUNDS = 3
"""A bound is gone through so often, the last one ten times as often."""
LEAST_SHARE = 0.005
"""Rounds end where one takes out fewer corners than this share of the faces."""


def coarser(link: Link) -> tuple[Link, ...]:
    """The link as it is, and with fewer and fewer triangles, for each of `BOUNDS_M`.

    Each point of a coarser link's surface lies within the bound of the fine one's, and the other way about; what lies
    farther from both is inside of both or of neither. Corners are taken out one by one, and what moves by it is bounded
    as it happens: so the bounds hold whatever the mesh is like, open, crossing itself or turned inside out.

    Args:
        link: of any mesh. One of few triangles comes alone.
    """
    if len(link.faces) <= FEW_TRIANGLES:
        return (link,)
    made = [link]
    surface, lines = _joined(link)
    for bound_m in BOUNDS_M:
        surface = _thinned(surface, bound_m, MOST_ROUNDS * (10 if bound_m == BOUNDS_M[-1] else 1))
        made.append(_link(link.name, surface, lines))
    return tuple(made)


def _joined(link: Link) -> tuple[Surface, NDArray[np.int64]]:
    """A link's triangles with corners at one place made one; faces of two corners that are no other face's edge."""
    points, of = _places(link.vertices)
    faces = of[link.faces]
    whole = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    surface = Surface(points, np.ascontiguousarray(faces[whole]), np.zeros(int(whole.sum())))
    lines = faces[~whole]
    if len(lines):
        edges = surface.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        number = len(points) * edges.min(axis=1) + edges.max(axis=1)
        first, last = lines.min(axis=1), lines.max(axis=1)
        there = np.where(first == last, np.isin(first, edges), np.isin(len(points) * first + last, number))
        lines = lines[~there]
    return surface, lines


def _places(vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Each place that some corners are at once, shape (n, 3), and for each corner its place."""
    # zero has two signs
    given = vertices + 0.0
    mixed = given.view(np.uint64) * np.array(
        [0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64
    )
    _, first, of = np.unique(
        (mixed ^ (mixed >> np.uint64(29))).sum(axis=1), return_index=True, return_inverse=True
    )
    # in the order in which they come: neighbours in space are mostly neighbours there
    order = np.argsort(first)
    points, of = given[first[order]], np.argsort(order)[of]
    if (points[of] == given).all():
        return points, of
    # two places of one number
    points, of = np.unique(given, axis=0, return_inverse=True)
    return points, of.reshape(-1)


def _thinned(surface: Surface, bound_m: float, rounds: int) -> Surface:
    """The surface after some rounds; corners keep their numbers."""
    points, faces, error = surface.points, surface.faces.copy(), surface.error.copy()
    stays = np.zeros(len(points))
    for _ in range(rounds):
        fans = Fans(np.empty(len(points) + 1, dtype=np.int64), np.empty(3 * len(faces), dtype=np.int64))
        list_fans(faces, fans)
        marks = Marks(np.zeros(len(points), dtype=np.bool_), stays)
        removed = thin(Surface(points, faces, error), fans, marks, bound_m)
        left = faces[:, 0] >= 0
        faces, error = faces[left], error[left]
        if removed <= LEAST_SHARE * len(faces):
            break
    return Surface(points, faces, error)


def _link(name: str, surface: Surface, lines: NDArray[np.int64]) -> Link:
    faces = np.concatenate([surface.faces, lines])
    used, numbers = np.unique(faces, return_inverse=True)
    return Link(name, surface.points[used], numbers.reshape(-1, 3).astype(np.int32))
