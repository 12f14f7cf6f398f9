"""What images show instead of the board that a site describes: another count, another unit of depth, no mark."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.errors import CalibrationError, FrameError
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import spread
from elbowroom.sources.layouts.image import Image

LOOKED_AT = 9
"""Images that are looked at again."""
UNITS = (0.2, 5.0, 0.25, 4.0, 0.1, 10.0, 0.001, 1000.0, 0.5, 2.0)
"""Factors by which units of depth are mistaken: 0.2 mm for 1 mm, quarters and tenths of a millimetre, metres."""
LENSES = (2.0, 0.5, 1.5, 2 / 3, 3.0, 1 / 3, 4.0, 0.25)
"""Factors between the sizes of image that one sensor delivers."""
LEAST_VIEWS, AS_OFTEN = 2, 3
"""Another description is believed if so many images show it, and so many times as many as the site's own."""

Seen = BoardView | Trouble
Work = Sequence[tuple[Image, int]]
Look = Callable[[Board, Image, int], Seen]


@dataclass(frozen=True, slots=True)
class Looks:
    """Ways to look for a board in an image.

    Args:
        plain: as `seen_in`.
        mirrored: in the image turned left to right.
        other_sizes: for its pattern with larger and smaller squares.
    """

    plain: Look
    mirrored: Look
    other_sizes: Look


def closer_look(
    board: Board, work: Work, looks: Looks, *, others_see_it: bool, seen_share: float = 0.0
) -> str | None:
    """What the images show where they do not show the board, a sentence; None: nothing that can be told.

    Args:
        board: as the site describes it.
        work: images, and the number of their pose.
        looks: how to look for it.
        others_see_it: whether other cameras see the board as it is described: then it is not the description.
        seen_share: in so much of all images of these cameras the board is seen as it is described.
    """
    look = looks.plain
    few = [work[n] for n in np.unique(np.linspace(0, len(work) - 1, min(len(work), LOOKED_AT)).astype(int))]
    # few images may happen to show it in none where all of them do in many
    own = max(_views(board, few, look), seen_share * len(few))
    enough = int(np.ceil(max(LEAST_VIEWS, AS_OFTEN * own)))
    if others_see_it and _views(board, few, looks.mirrored) >= enough:
        return "the board is there in the images mirrored left to right; switch mirroring off in the camera's driver"
    counted = None if others_see_it else _counted(board, few, look, enough)
    if counted is not None:
        # a board in a mirror is one with its sides exchanged
        mirrored = ", or all images are mirrored" if counted == (board.rows, board.columns) else ""
        return (
            f"the images show {counted[0]} x {counted[1]} inner corners (columns x rows), not {board.columns} x "
            f"{board.rows}{mirrored}"
        )
    factor = _unit(board, few, look, enough)
    if factor is not None:
        return (
            f"the board is there if depth counts {factor:g} times as much: depth_scale_m of "
            f"{factor * few[0][0].scale_m:.4g} instead of {few[0][0].scale_m:g}"
        )
    lens = _lens(board, few, look, enough)
    if lens is not None:
        camera = few[0][0].camera
        return (
            f"the board is there if fx, fy, cx and cy of camera {camera.name} are {lens:g} times as large: the site's "
            f"lens is that of another size of image than {camera.width} x {camera.height}"
        )
    if board.marked and not others_see_it and _views(replace(board, marked=False), few, look) >= enough:
        faults = [seen for seen in spread(lambda item: look(board, *item), few) if isinstance(seen, Trouble)]
        if sum(one.fault is Fault.MIRRORED for one in faults) < enough:
            return "the board is there without its mark: say marked: false if it bears none, or look at the other side"
    sizes = [
        seen
        for seen in spread(lambda item: looks.other_sizes(board, *item), few)
        if isinstance(seen, Trouble) and seen.fault is Fault.WRONG_SIZE
    ]
    if len(sizes) < LEAST_VIEWS:
        return None
    more = "; its fx, or its depth_scale_m, is of another size of image or unit" if others_see_it else ""
    return f"{sizes[len(sizes) // 2]}{more}"


def _views(board: Board, few: Work, look: Look) -> int:
    """How many images show a board; none where the first third of them shows none."""
    first = few[::3]
    views = sum(isinstance(seen, BoardView) for seen in spread(lambda item: look(board, *item), first))
    if not views:
        return 0
    rest = [item for n, item in enumerate(few) if n % 3]
    return views + sum(isinstance(seen, BoardView) for seen in spread(lambda item: look(board, *item), rest))


def _counted(board: Board, few: Work, look: Look, enough: int) -> tuple[int, int] | None:
    """Columns and rows of a board that the images show better: sides exchanged, squares counted, one or two off."""
    best: tuple[int, tuple[int, int]] | None = None
    for columns, rows in _other_counts(board.columns, board.rows):
        try:
            other = replace(board, columns=columns, rows=rows)
        except CalibrationError:
            continue
        views = _views(other, few, look)
        if views >= enough and (best is None or views > best[0]):
            best = views, (columns, rows)
        if 2 * views > len(few):
            break
    return None if best is None else best[1]


def _other_counts(columns: int, rows: int) -> list[tuple[int, int]]:
    near = [
        (columns + a, rows + b) for a in (-2, -1, 0, 1, 2) for b in (-2, -1, 0, 1, 2) if abs(a) + abs(b) == 2
    ]
    sides = [(rows, columns), (rows - 1, columns - 1), (rows + 1, columns + 1)]
    return [other for other in dict.fromkeys(sides + near) if other != (columns, rows)]


def _unit(board: Board, few: Work, look: Look, enough: int) -> float | None:
    """By how much the unit of depth is to be multiplied so that the board shows."""
    for factor in UNITS:
        scaled = [(image._replace(scale_m=factor * image.scale_m), pose) for image, pose in few]
        # a factor by which depths are hundreds of metres is none, which the frame itself refuses
        with suppress(FrameError):
            if _views(board, scaled, look) >= enough:
                return factor
    return None


def _lens(board: Board, few: Work, look: Look, enough: int) -> float | None:
    """By how much lenses are to be scaled so that the board shows."""
    for factor in LENSES:
        scaled = [(image._replace(camera=_scaled(image.camera, factor)), pose) for image, pose in few]
        if _views(board, scaled, look) >= enough:
            return factor
    return None


def _scaled(camera: DepthCamera, factor: float) -> DepthCamera:
    """The camera with the lens that it has in images so many times as large; pixels count from their middle."""
    k = camera.intrinsics
    middle = (factor * (k.cx + 0.5) - 0.5, factor * (k.cy + 0.5) - 0.5)
    return replace(
        camera, intrinsics=replace(k, fx=factor * k.fx, fy=factor * k.fy, cx=middle[0], cy=middle[1])
    )
