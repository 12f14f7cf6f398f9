"""What a body covers beside it as it sets out: how far it presses what stands there.

A round link that turns about its own axis leads nowhere, but the edges of its facets go outward and inward by turns,
and one that moves at a slant presses slowly. So it is added up how far the surface moves outward in the blocked voxels
that it reaches into, and the way ends before that may be more than `PRESSED_M`: of what stands there, nothing that is
farther from the body is met before.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry.kept import kept
from elbowroom.machine import Machine
from elbowroom.machine.shape import Shape
from elbowroom.motion.course import Way
from elbowroom.motion.kernels.mover import Skin
from elbowroom.motion.kernels.outward import Boxes, Faces, Moves, first_outward
from elbowroom.motion.pieces import cut

PRESSED_M = 0.00025
"""What stands in voxels that a link reaches into, and nearer to it than this, may be pressed by as much [m]."""
FINER = 2
"""Intervals are so many times shorter than the shortest of the sweep."""
TOGETHER = 32
"""So many triangles are passed over at once, if none is near."""
SHARPEST = 1e3
"""No edge is taken for sharper: it goes outward as fast as it moves."""
THIN_M = 1e-6
"""Lower triangles lie on their neighbours' edges, and their normals are rounding [m]."""
LOOKS = 24
"""So often a direction is turned until it goes with all normals at a corner as well as it can."""


class Pressed(NamedTuple):
    """Where a way ends since a link may press what it reaches into: the travel, the rows of the box and of the link."""

    travel: float
    box: int
    link: int


def first_pressed(
    machine: Machine, faces: Faces, boxes: Boxes, way: Way, speeds: NDArray[np.float64], skin: Skin
) -> Pressed | None:
    """Where a way's surface may first have moved outward by more than `PRESSED_M` in some boxes.

    Args:
        machine: what moves.
        faces: of `faces_of`.
        boxes: where it counts, and for which links.
        way: where the motion leads; not beside it.
        speeds: of the skin's clusters along it, 0 for those that are not asked.
        skin: of the machine.

    Returns:
        That place; None: nowhere on the way.
    """
    rates = np.zeros(len(machine.links))
    np.maximum.at(rates, skin.link, speeds)
    links = boxes.links & (rates > 0)
    some = np.flatnonzero(links.any(axis=1))
    if not some.size:
        return None
    own = Boxes(boxes.corner[some], boxes.edge, boxes.parts[some], links[some])
    mine = np.isin(faces.link, np.flatnonzero(links.any(axis=0)))
    groups = {name: getattr(faces, name)[mine] for name in ("start", "stop", "link", "centre", "radius")}
    asked = faces._replace(**groups)
    moves = Moves(machine.tree, machine.world_from_base, way.course)
    at = _intervals(way, rates.max(), own.edge)
    index, box, link = first_outward(moves, asked, own, at, rates, PRESSED_M)
    return None if index < 0 else Pressed(float(at[index]), int(some[box]), link)


def _intervals(way: Way, fastest: float, edge: float) -> NDArray[np.float64]:
    """Travels, such that no point moves farther than a part of a voxel between two of them, and no knot lies there."""
    knots = way.course.travel
    knots = np.append(knots[knots < way.length], way.length)
    step = edge / (16 * FINER) / fastest
    ends = [
        np.linspace(one, other, int(np.ceil((other - one) / step)) + 1)[:-1] for one, other in pairwise(knots)
    ]
    return np.append(np.concatenate(ends), way.length)


@kept
def faces_of(shape: Shape, rows: tuple[int, ...], bound_m: float) -> Faces:
    """The surface of links, and which way is outward.

    Args:
        shape: of a machine.
        rows: of the links.
        bound_m: how far the triangles may lie off [m].
    """
    links = shape.within(bound_m)
    found = [_Piece.of(row, piece) for row in rows for piece in cut(links[row].triangles)]
    groups = [(piece, some) for piece in found for some in _groups(piece.triangles)]
    sizes = [len(some) for _, some in groups]
    triangles = np.concatenate([np.zeros((0, 3, 3)), *(piece.triangles[some] for piece, some in groups)])
    balls = [_ball(piece.triangles[some]) for piece, some in groups]
    stop = np.cumsum(sizes, dtype=np.int64)
    return Faces(
        triangles,
        np.concatenate([np.zeros(0), *(piece.sharp[some] for piece, some in groups)]),
        np.repeat(np.array([piece.sided for piece, _ in groups], dtype=np.bool_), sizes),
        stop - sizes,
        stop,
        np.array([piece.row for piece, _ in groups], dtype=np.int64),
        np.array([centre for centre, _ in balls]).reshape(-1, 3),
        np.array([radius for _, radius in balls]),
    )


class _Piece(NamedTuple):
    """Triangles of a link that hang together, normals outward if that is known, and how sharp their edges are."""

    row: int
    triangles: NDArray[np.float64]
    sided: bool
    sharp: NDArray[np.float64]

    @classmethod
    def of(cls, row: int, triangles: NDArray[np.float64]) -> "_Piece":
        outward, sided = _outward(triangles)
        some = _heights(outward) > THIN_M
        return cls(row, np.ascontiguousarray(outward[some]), sided, _sharp(outward)[some])


def _groups(triangles: NDArray[np.float64]) -> list[NDArray[np.int64]]:
    """The numbers of triangles that lie close together, `TOGETHER` at most in each list: halves of halves."""
    middle, left, done = triangles.mean(axis=1), [np.arange(len(triangles))], []
    while left:
        some = left.pop()
        if len(some) <= TOGETHER:
            done.append(some)
            continue
        order = some[np.argsort(middle[some, np.ptp(middle[some], axis=0).argmax()], kind="stable")]
        left += [order[: len(order) // 2], order[len(order) // 2 :]]
    return [some for some in done if len(some)]


def _ball(triangles: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """A ball about triangles: its middle and radius [m]."""
    corners = triangles.reshape(-1, 3)
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return centre, float(np.linalg.norm(corners - centre, axis=1).max())


def _heights(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of triangles above their longest sides, shape (m,) [m]."""
    sides = np.roll(triangles, -1, axis=1) - triangles
    double = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    heights: NDArray[np.float64] = double / np.maximum(np.linalg.norm(sides, axis=2).max(axis=1), 1e-12)
    return heights


def _outward(piece: NDArray[np.float64]) -> tuple[NDArray[np.float64], bool]:
    """Triangles with their normals outward, and whether that is known: each edge is gone along once either way."""
    corner = _numbers(piece)
    one, other = corner.ravel(), np.roll(corner, -1, axis=1).ravel()
    most = corner.max() + 1
    ahead, back = np.sort(one * most + other), np.sort(other * most + one)
    volume = np.einsum("ni,ni->", piece[:, 0], np.cross(piece[:, 1], piece[:, 2]))
    size = np.ptp(piece.reshape(-1, 3), axis=0).max()
    sided = bool((ahead == back).all()) and abs(volume) > 1e-9 * size**3
    return (piece[:, ::-1] if volume < 0 else piece), sided


def _numbers(piece: NDArray[np.float64]) -> NDArray[np.int64]:
    """Of each triangle's corners, equal where these are at one place, shape (m, 3)."""
    _, number = np.unique(piece.reshape(-1, 3), axis=0, return_inverse=True)
    return number.reshape(-1, 3)


def _sharp(piece: NDArray[np.float64]) -> NDArray[np.float64]:
    """How much faster a corner or an edge of each triangle may go outward than the triangles that meet there.

    What is nearest to a corner lies in a direction d = sum of a_i n_i of the normals there, a_i >= 0, and the corner
    goes there no faster than (sum of a_i) times the fastest of these triangles does outward. For any unit vector m with
    m n_i >= c > 0 for all of them, that sum is 1 / c at most.
    """
    corner = _numbers(piece)
    normal = np.cross(piece[:, 1] - piece[:, 0], piece[:, 2] - piece[:, 0])
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.divide(normal, size, out=np.zeros_like(normal), where=size > 0)
    thin = np.repeat(_heights(piece) <= THIN_M, 3)
    order = np.argsort(corner.ravel(), kind="stable")
    of, thin = np.repeat(normal, 3, axis=0)[order], thin[order]
    start = np.flatnonzero(np.diff(corner.ravel()[order], prepend=-1))
    group = np.repeat(np.arange(len(start)), np.diff(np.append(start, len(of))))
    along = np.add.reduceat(of, start)
    best = np.full(len(start), 1 / SHARPEST)
    for look in range(LOOKS):
        length = np.linalg.norm(along, axis=1)
        unit = np.divide(along, length[:, None], out=np.zeros_like(along), where=length[:, None] > 0)
        goes = np.where(thin, 1.0, np.einsum("ni,ni->n", unit[group], of))
        least = np.minimum.reduceat(goes, start)
        best = np.maximum(best, least)
        worst = np.minimum.reduceat(np.where(goes <= least[group], np.arange(len(of)), len(of)), start)
        if look == 0:
            along = unit
        along = along + (of[worst] - along) / (look + 2)
    sharp: NDArray[np.float64] = (1 / best)[corner].max(axis=1)
    return sharp
