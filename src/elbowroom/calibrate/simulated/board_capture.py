"""A capture of a board that is held up all over the room, and laid on the floor once or put on stands."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.extrinsics.anchor import POINT_SIGMA_M
from elbowroom.calibrate.simulated.hand_poses import Shown, floor_pose, hand_poses, shown
from elbowroom.calibrate.simulated.stand_poses import stand_poses
from elbowroom.calibrate.simulated.start import TrueCamera, moved
from elbowroom.calibrate.simulated.writer import INFRARED_FOLDER, CaptureWriter
from elbowroom.errors import CalibrationError
from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.parallel import spread
from elbowroom.simulate import Moment, Solid, render
from elbowroom.simulate.board_plate import plate_mesh
from elbowroom.simulate.furniture import shell
from elbowroom.simulate.infrared import infrared_image
from elbowroom.site.calibration_entry import WorldFromBoard

PERIOD_NS = 2_000_000_000
"""From one pose to the next [ns]."""
GRID = VoxelGrid((-2.0, -2.0, 0.0), (80, 80, 50), 0.05)


@dataclass(frozen=True, slots=True, eq=False)
class BoardCapture:
    """What is to be captured.

    Args:
        cameras: true and said.
        board: the board.
        poses: how often it is shown, the pose on the floor or those on stands among them.
        stands: on so many stands the board is put, and three of its corners are measured there, to `MEASURED_M`: that
            fixes the world. 0: the board is laid on the floor, which defines the world.
        noise: name of the sensors' noise, for the site file; the cameras themselves have the model.
        seed: of all random numbers.
        hand_moved_m, hand_turned_deg: how far a hand moves the board between the exposures of different cameras.
        moved_pose: in this pose the board is moved on by `MOVED_M` while half of the cameras have yet to see it; None:
            in none.
        near: each pose right before one camera, for intrinsics.
        all_views: also images that show a part of the board or its back, as a real capture has.

    Raises:
        CalibrationError: fewer than two poses, or than stands.
    """

    cameras: tuple[TrueCamera, ...]
    board: Board
    poses: int = 40
    stands: int = 0
    noise: str = "kinect_v1"
    seed: int = 1
    hand_moved_m: float = 0.0002
    hand_turned_deg: float = 0.01
    moved_pose: int | None = None
    near: bool = False
    all_views: bool = True

    def __post_init__(self) -> None:
        if self.poses < 2:
            raise CalibrationError(f"capture: {self.poses} poses, must be at least 2")
        if not 0 <= self.stands <= self.poses:
            raise CalibrationError(f"capture: {self.stands} stands, must be 0 to the {self.poses} poses")


MOVED_M = 0.03
MEASURED_M = POINT_SIGMA_M
"""Sigma of each coordinate of a corner that is measured [m]."""


def record_board(
    capture: BoardCapture, out: Path, on_pose: Callable[[int, int], None] = lambda done, views: None
) -> Path:
    """Renders and writes a capture.

    Args:
        capture: what is to be captured.
        out: folder.
        on_pose: is told how many poses are done, and how many images the last one gave.

    Returns:
        The site file.

    Raises:
        CalibrationError: no place for the board, or a folder that holds images.
        InputError: a folder that cannot be written to.
    """
    writer = CaptureWriter(out, capture.cameras)
    random = np.random.default_rng([capture.seed, 17])
    true_cameras = [camera.true for camera in capture.cameras]
    fixed = _on_stands(capture, random) if capture.stands else _on_the_floor(capture.board)
    poses = list(fixed.poses)
    poses += hand_poses(
        true_cameras, capture.board, capture.poses - len(poses), random, taken=poses, near=capture.near
    )
    rows = []
    for number, pose in enumerate(poses):
        seen = _show(capture, writer, number, pose, random, by_hand=number >= len(fixed.poses))
        rows.append(
            {
                "stamp_ns": _stamp(number),
                "world_from_board": pose.tolist(),
                "whole": [name for name, view in seen.items() if view.whole and view.front],
                "part": [name for name, view in seen.items() if view.front and not view.whole],
                "back": [name for name, view in seen.items() if not view.front],
            }
        )
        on_pose(number + 1, len(seen))
    writer.truth({"poses": rows})
    return writer.site(capture.noise, {"calibration": _said(capture.board, fixed)}, GRID)


class _Fixed(NamedTuple):
    """What fixes the world: the first poses, world_from_board each of shape (4, 4), and `calibration.world`."""

    poses: list[NDArray[np.float64]]
    world: dict[str, object]


def _on_the_floor(board: Board) -> _Fixed:
    first_corner_m, x_axis_deg = floor_pose(board)
    lying = WorldFromBoard(by="board", pose=0, first_corner_m=first_corner_m, x_axis_deg=x_axis_deg)
    return _Fixed([lying.world_from_board], lying.model_dump(mode="json"))


def _on_stands(capture: BoardCapture, random: np.random.Generator) -> _Fixed:
    """The board on stands, of which somebody measures the first corner, the end of its row and that of its column."""
    board = capture.board
    poses = stand_poses([camera.true for camera in capture.cameras], board, capture.stands, random)
    points = []
    for pose, world_from_board in enumerate(poses):
        for column, row in ((0, 0), (board.columns - 1, 0), (0, board.rows - 1)):
            on_board = board.square_m * np.array([column, row, 0.0])
            place = world_from_board[:3, :3] @ on_board + world_from_board[:3, 3]
            measured = place + random.normal(0.0, MEASURED_M, 3)
            points.append(
                {
                    "name": f"stand {pose}, column {column}, row {row}",
                    "world_m": np.round(measured, 4).tolist(),
                    "corner": {"pose": pose, "column": column, "row": row},
                }
            )
    return _Fixed(poses, {"by": "points", "sigma_m": MEASURED_M, "points": points})


def _stamp(number: int) -> int:
    return (number + 1) * PERIOD_NS


def _show(
    capture: BoardCapture,
    writer: CaptureWriter,
    number: int,
    pose: NDArray[np.float64],
    random: np.random.Generator,
    by_hand: bool,
) -> dict[str, Shown]:
    """Renders the board at one pose for each camera that has it in view."""
    seen: dict[str, Shown] = {}
    work: list[tuple[TrueCamera, NDArray[np.float64]]] = []
    for index, camera in enumerate(capture.cameras):
        held = pose @ moved(capture.hand_turned_deg, capture.hand_moved_m, random) if by_hand else pose
        if number == capture.moved_pose and index % 2:
            held = held @ moved(0.0, MOVED_M, random)
        view = shown(camera.true, capture.board, held)
        if (view.whole and view.front) or (capture.all_views and view.any_part):
            seen[camera.true.name] = view
            work.append((camera, held))

    def one(item: tuple[TrueCamera, NDArray[np.float64]]) -> None:
        camera, held = item
        plate = Solid("board", plate_mesh(capture.board), held)
        moment = Moment(_stamp(number) / 1e9, (*shell(), plate), {})
        frame = render([camera.true], moment, seed=capture.seed)[0]
        writer.depth(camera, _stamp(number), frame.depth_m)
        if capture.board.kind == "printed":
            grey = infrared_image(camera.true, moment, capture.board, plate, seed=capture.seed)
            writer.infrared(camera, _stamp(number), grey)

    spread(one, work)
    return seen


def _said(board: Board, fixed: _Fixed) -> dict[str, object]:
    """The key `calibration` of the site file."""
    images: dict[str, object] = {"kind": "depth"}
    if board.kind == "printed":
        images = {"kind": "infrared", "folder": INFRARED_FOLDER}
    return {
        "board": {
            "columns": board.columns,
            "rows": board.rows,
            "square_m": board.square_m,
            "kind": board.kind,
            "border_m": board.border_m,
            "marked": board.marked,
            "thickness_m": board.thickness_m,
        },
        "images": images,
        "world": fixed.world,
    }
