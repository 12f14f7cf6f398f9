"""Cameras and poses of the board as a graph: does it hang together, and where everything stands to begin with.

Two cameras that saw the board in the same poses have one relative pose. Each shared pose proposes one (more than one
where a view is in doubt); the proposal that most shared poses agree with is taken, and what it is supported by is the
edge's weight. A maximum spanning tree over these edges places all cameras, then each pose of the board where its views
agree.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.seen_board import SeenBoard, spread
from elbowroom.errors import CalibrationError
from elbowroom.geometry import invert_rigid

Array = NDArray[np.float64]
LEAST_TOLERANCE_M = 0.003
SIGMAS = 4.0
NEAR_M = 0.03
"""A pose of the board that two cameras place so near to each other, and by their own sigmas, is seen alike."""


@dataclass(frozen=True, slots=True, eq=False)
class Relative:
    """Where one camera is beside another, by the poses of the board that both saw.

    Args:
        one, other: their names.
        one_from_other: shape (4, 4).
        support: how many poses agree with it, finely counted: the edge's weight.
        shared: how many both saw.
        alike: how many of these they place alike, by it.
    """

    one: str
    other: str
    one_from_other: Array
    support: float
    shared: int
    alike: int


def require_one_piece(names: Sequence[str], seen: Sequence[SeenBoard]) -> None:
    """Every camera saw the board, and together with others.

    Args:
        names: of the cameras that are to be placed.
        seen: views.

    Raises:
        CalibrationError: a camera that never saw the board, or groups of cameras that share no pose of it.
    """
    saw: dict[str, set[int]] = {name: set() for name in names}
    for one in seen:
        saw[one.view.camera].add(one.view.pose)
    blind = [name for name, poses in saw.items() if not poses]
    if blind:
        raise CalibrationError(
            f"the board was never seen by {_listed(blind)}; show it where this camera and another one see it, "
            "or take the camera out of the site"
        )
    groups = _groups(saw)
    if len(groups) > 1:
        groups.sort(key=len, reverse=True)
        raise CalibrationError(
            f"{_listed(groups[0])} and {_listed(groups[1])} share no pose of the board"
            + (f" ({len(groups)} groups in all)" if len(groups) > 2 else "")
            + "; show it where a camera of each group sees it at the same time"
        )


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
    return f"{'camera' if len(names) == 1 else 'cameras'} {shown}"


def _groups(saw: Mapping[str, set[int]]) -> list[list[str]]:
    """Cameras that hang together by poses that they share."""
    left, groups = list(saw), []
    while left:
        group = [left.pop(0)]
        poses = set(saw[group[0]])
        grown = True
        while grown:
            joining = [name for name in left if saw[name] & poses]
            grown = bool(joining)
            for name in joining:
                left.remove(name)
                group.append(name)
                poses |= saw[name]
        groups.append(group)
    return groups


def shared_poses(seen: Sequence[SeenBoard]) -> dict[tuple[str, str], int]:
    """How many poses each two cameras saw together, by their names in alphabetical order."""
    by_pose = defaultdict(set)
    for one in seen:
        by_pose[one.view.pose].add(one.view.camera)
    counts: dict[tuple[str, str], int] = defaultdict(int)
    for cameras in by_pose.values():
        for a in cameras:
            for b in cameras:
                if a < b:
                    counts[a, b] += 1
    return dict(counts)


def first_solution(
    names: Sequence[str], seen: Sequence[SeenBoard], corners: Array
) -> tuple[dict[str, Array], dict[int, Array]]:
    """Poses of all cameras and of the board, in the frame of the camera that has most views.

    Args:
        names: of the cameras; all hang together.
        seen: views.
        corners: of the board, shape (n, 3), board frame [m].

    Returns:
        base_from_camera by name, base_from_board by pose.
    """
    edges = relatives(names, seen, corners)
    counts = {name: sum(one.view.camera == name for one in seen) for name in names}
    root = max(names, key=lambda name: counts[name])
    base_from_camera = {root: np.eye(4)}
    while len(base_from_camera) < len(names):
        edge = max(
            (edge for edge in edges if (edge.one in base_from_camera) != (edge.other in base_from_camera)),
            key=lambda edge: edge.support,
        )
        if edge.one in base_from_camera:
            base_from_camera[edge.other] = base_from_camera[edge.one] @ edge.one_from_other
        else:
            base_from_camera[edge.one] = base_from_camera[edge.other] @ invert_rigid(edge.one_from_other)
    return base_from_camera, _boards(seen, base_from_camera, outermost(corners))


def outermost(corners: Array) -> Array:
    """Four corners of the board that lie farthest out, shape (4, 3)."""
    return corners[[0, int(np.argmax(corners[:, 0])), int(np.argmax(corners[:, 1])), len(corners) - 1]]


def relatives(names: Sequence[str], seen: Sequence[SeenBoard], corners: Array) -> list[Relative]:
    """Each two cameras that saw the board in the same poses.

    Args:
        names: of the cameras.
        seen: views.
        corners: of the board, shape (n, 3), board frame [m].
    """
    views: dict[str, dict[int, SeenBoard]] = {name: {} for name in names}
    for one in seen:
        views[one.view.camera][one.view.pose] = one
    box, edges = outermost(corners), []
    for number, a in enumerate(names):
        for b in names[number + 1 :]:
            common = sorted(views[a].keys() & views[b].keys())
            if common:
                edges.append(relative([views[a][p] for p in common], [views[b][p] for p in common], box))
    return edges


def relative(a: Sequence[SeenBoard], b: Sequence[SeenBoard], box: Array) -> Relative:
    """The relative pose that most of the poses seen by both agree with, and by how many it is supported.

    Args:
        a, b: views of two cameras, of the same poses in the same order.
        box: corners of the board that lie farthest out, shape (4, 3) [m].
    """
    pairs = [
        (number, one, other)
        for number, (in_a, in_b) in enumerate(zip(a, b, strict=True))
        for one in in_a.lone
        for other in in_b.lone
    ]
    number = np.array([n for n, _, _ in pairs])
    in_a = np.array([_moved(one.camera_from_board, box) for _, one, _ in pairs])
    in_b = np.array([_moved(other.camera_from_board, box) for _, _, other in pairs])
    reach = float(np.abs(box).max())
    own_spread = np.array([np.hypot(spread(one, reach), spread(other, reach)) for _, one, other in pairs])
    best: tuple[float, float, Array] | None = None
    for (_, one, other), own in zip(pairs, own_spread, strict=True):
        a_from_b = one.camera_from_board @ invert_rigid(other.camera_from_board)
        off = np.linalg.norm(in_a - _moved(a_from_b, in_b), axis=2).max(axis=1)
        agreed = np.zeros(len(a))
        np.maximum.at(agreed, number, np.exp(-((off / (LEAST_TOLERANCE_M + SIGMAS * own_spread)) ** 2)))
        # of equal support the sharper proposal goes first
        if best is None or (round(agreed.sum(), 1), -own) > best[:2]:
            best = (round(float(agreed.sum()), 1), -float(own), a_from_b)
    assert best is not None
    off = np.linalg.norm(in_a - _moved(best[2], in_b), axis=2).max(axis=1)
    alike = {int(n) for n in number[off < NEAR_M + SIGMAS * own_spread]}
    support = best[0] + 1e-3 / (1e-3 - best[1])
    return Relative(a[0].view.camera, b[0].view.camera, best[2], support, len(a), len(alike))


def _moved(to_from_from: Array, points: Array) -> Array:
    return np.asarray(points @ to_from_from[:3, :3].T + to_from_from[:3, 3])


def _boards(seen: Sequence[SeenBoard], base_from_camera: Mapping[str, Array], box: Array) -> dict[int, Array]:
    """Each pose of the board as the view says it that the other views agree with most."""
    by_pose: dict[int, list[SeenBoard]] = defaultdict(list)
    for one in seen:
        by_pose[one.view.pose].append(one)
    boards, reach = {}, float(np.abs(box).max())
    for pose, views in by_pose.items():
        said = [(number, lone) for number, one in enumerate(views) for lone in one.lone]
        placed = [base_from_camera[views[n].view.camera] @ lone.camera_from_board for n, lone in said]
        number = np.array([n for n, _ in said])
        at = np.array([_moved(base_from_board, box) for base_from_board in placed])
        own_spread = np.array([spread(lone, reach) for _, lone in said])
        worth = []
        for own in range(len(said)):
            off = np.linalg.norm(at - at[own], axis=2).max(axis=1)
            agreed = np.exp(
                -((off / (LEAST_TOLERANCE_M + SIGMAS * np.hypot(own_spread, own_spread[own]))) ** 2)
            )
            best = np.zeros(len(views))
            np.maximum.at(best, number, agreed)
            worth.append((round(float(best.sum()), 1), -float(own_spread[own])))
        boards[pose] = placed[max(range(len(said)), key=lambda n: worth[n])]
    return boards
