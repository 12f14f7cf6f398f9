"""A camera that places the board elsewhere than all others do, pose after pose: a pose late, mirrored, or moved."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.seen_board import SeenBoard, seen_board
from elbowroom.calibrate.extrinsics.graph import Relative, outermost, relative, relatives
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera

LEAST_SHARED = 4
"""Two cameras with fewer poses in common say nothing of each other here."""
ALIKE, MENDED = 0.5, 0.8
"""Share of the common poses that two cameras must place alike; and that is enough for an explanation."""
SHIFTS = (-1, 1, -2, 2)
"""By so many poses a camera may be late."""


def require_in_step(cameras: Mapping[str, DepthCamera], board: Board, seen: Sequence[SeenBoard]) -> None:
    """Cameras that share poses of the board place it alike in most of them.

    Args:
        cameras: by name.
        board: what was shown.
        seen: views.

    Raises:
        CalibrationError: a camera that agrees with no other, with what makes it agree if that is found; or two of which
            nobody can tell which one it is.
    """
    corners = board.corners_in_board
    pairs = [one for one in relatives(list(cameras), seen, corners) if one.shared >= LEAST_SHARED]
    apart = [pair for pair in pairs if pair.alike < ALIKE * pair.shared]
    if not apart:
        return
    blamed = [_Blamed(name, [p for p in pairs if name in (p.one, p.other)]) for name in cameras]
    suspects = sorted((one for one in blamed if one.apart), key=lambda one: (-one.apart_share, -one.apart))
    suspect = suspects[0]
    alone = all(suspect.name in (pair.one, pair.other) for pair in apart)
    shared, alike = suspect.shared, suspect.alike
    others = sorted({p.other if p.one == suspect.name else p.one for p in suspect.pairs})
    if alone and len(others) > 1:
        raise CalibrationError(
            f"camera {suspect.name}: places the board elsewhere than the others in {shared - alike} of {shared} "
            f"common poses; {_explained(suspect.name, cameras, board, seen)}"
        )
    if alone:
        why = _explained(suspect.name, cameras, board, seen)
        raise CalibrationError(
            f"cameras {suspect.name} and {others[0]}: place the board apart in {shared - alike} of {shared} common "
            f"poses; of camera {suspect.name}: {why}"
        )
    names = ", ".join(one.name for one in suspects if one.apart_share >= MENDED * suspect.apart_share)
    raise CalibrationError(
        f"cameras {names}: place the board apart in most of their common poses; images that belong to other poses or "
        "cameras, a board that was moved between their images, or wrong intrinsics: capture again"
    )


@dataclass(frozen=True, slots=True)
class _Blamed:
    """A camera and the pairs that it is one of."""

    name: str
    pairs: list[Relative]

    @property
    def shared(self) -> int:
        return sum(pair.shared for pair in self.pairs)

    @property
    def alike(self) -> int:
        return sum(pair.alike for pair in self.pairs)

    @property
    def apart(self) -> int:
        return sum(pair.alike < ALIKE * pair.shared for pair in self.pairs)

    @property
    def apart_share(self) -> float:
        return self.apart / max(len(self.pairs), 1)


def _explained(name: str, cameras: Mapping[str, DepthCamera], board: Board, seen: Sequence[SeenBoard]) -> str:
    """What makes a camera's views agree with all others, and what to do; or what else it may be."""
    mine = [one for one in seen if one.view.camera == name]
    rest = [one for one in seen if one.view.camera != name]
    for shift in SHIFTS:
        moved = [replace(one, view=replace(one.view, pose=one.view.pose + shift)) for one in mine]
        if _agrees(moved, rest, board):
            late = "late" if shift < 0 else "early"
            count = "one pose" if abs(shift) == 1 else f"{abs(shift)} poses"
            return (
                f"its images fit if each belongs to the pose {abs(shift)} {'before' if shift < 0 else 'after'}: it is "
                f"{count} {late}; name its images after the right poses, or capture again"
            )
    if any(_agrees(views, rest, board) for views in _unmirrored(mine, cameras[name], board)):
        return (
            "its images fit if mirrored left to right; switch mirroring off in its driver, and capture again"
        )
    return (
        "it was moved between poses, its images are another camera's or of other poses, or its intrinsics are wrong: "
        "fix it, calibrate intrinsics, and capture again"
    )


def _agrees(mine: Sequence[SeenBoard], rest: Sequence[SeenBoard], board: Board) -> bool:
    by_camera: dict[str, list[tuple[SeenBoard, SeenBoard]]] = {}
    own = {one.view.pose: one for one in mine}
    for other in rest:
        if other.view.pose in own:
            by_camera.setdefault(other.view.camera, []).append((own[other.view.pose], other))
    box = outermost(board.corners_in_board)
    pairs = [relative([a for a, _ in both], [b for _, b in both], box) for both in by_camera.values()]
    shared = sum(pair.shared for pair in pairs)
    return shared >= LEAST_SHARED and sum(pair.alike for pair in pairs) >= MENDED * shared


def _unmirrored(mine: Sequence[SeenBoard], camera: DepthCamera, board: Board) -> list[list[SeenBoard]]:
    """The views as an image turned left to right would have shown them; which end is the first is open."""
    found = []
    for along_rows in (True, False):
        views = []
        for one in mine:
            row, column = np.divmod(one.view.corner_ids, board.columns)
            ids = (
                row * board.columns + board.columns - 1 - column
                if along_rows
                else (board.rows - 1 - row) * board.columns + column
            )
            corners_px = (camera.width - 1, 0) + one.view.corners_px * (-1, 1)
            plane_px = (camera.width - 1, 0) + one.view.plane_px * (-1, 1)
            turned = replace(one.view, corner_ids=ids, corners_px=corners_px, plane_px=plane_px)
            try:
                views.append(seen_board({camera.name: camera}, board, turned))
            except CalibrationError:
                continue
        if views:
            found.append(views)
    return found
