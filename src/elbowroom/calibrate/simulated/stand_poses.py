"""Where somebody puts the board on stands: all around the room, each where many cameras see it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.simulated.hand_poses import count_views, in_room, worth_of
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.simulate.furniture import HALF_SIDE_M

STAND_TRIES = 1000
"""Places that are tried for each stand."""
STAND_OUT_M = 0.7
"""From the room's middle axis to the board's middle on a stand, at least: stands far apart tell of turns [m]."""
STAND_SECTOR = (0.35, 0.65)
"""Part of its sector of the room, seen from the middle axis, that a stand is in."""
STAND_HEIGHT_M = (0.6, 1.6)
"""Of the board's middle on a stand [m]."""
STAND_SLANT_DEG = (30.0, 60.0)
"""Of the board on a stand from lying: so cameras high on the walls look down on it from a metre or two."""


def stand_poses(
    cameras: Sequence[DepthCamera],
    board: Board,
    count: int,
    random: np.random.Generator,
    half_side_m: float = HALF_SIDE_M,
) -> list[NDArray[np.float64]]:
    """Poses of a board on stands: face up, slanted, all around the room's middle axis, each where many cameras see it.

    As somebody finds them who looks at the images: of many places in its sector of the room each stand takes the one
    that the cameras with fewest views so far see best.

    Args:
        cameras: with their true poses.
        board: the board.
        count: number of stands.
        random: source of randomness.
        half_side_m: the walls' distance from the room's middle [m].

    Returns:
        world_from_board, each of shape (4, 4).

    Raises:
        CalibrationError: no camera sees the board where a stand has room.
    """
    views = {camera.name: 0 for camera in cameras}
    cells: dict[tuple[str, int, int], int] = {}
    middle_in_board = board.corners_in_board.mean(axis=0)
    first_deg = random.uniform(0, 360)
    poses: list[NDArray[np.float64]] = []
    for number in range(count):
        best, most = None, 0.0
        for _ in range(STAND_TRIES):
            angle = np.radians(first_deg + (number + random.uniform(*STAND_SECTOR)) * 360 / count)
            out_m = random.uniform(STAND_OUT_M, half_side_m)
            middle = np.array([out_m * np.cos(angle), out_m * np.sin(angle), random.uniform(*STAND_HEIGHT_M)])
            pose = _slanted(middle, middle_in_board, random)
            if not in_room(board, pose, half_side_m):
                continue
            worth = worth_of(cameras, board, pose, views, cells)
            if worth > most:
                best, most = pose, worth
        if best is None:
            raise CalibrationError(
                f"stand {number}: no place on its side of the room where a camera sees a board of {board.columns} x "
                f"{board.rows} squares of {board.square_m} m; take fewer stands, or a smaller board"
            )
        count_views(cameras, board, best, views, cells)
        poses.append(best)
    return poses


def _slanted(
    middle: NDArray[np.float64], middle_in_board: NDArray[np.float64], random: np.random.Generator
) -> NDArray[np.float64]:
    """The board with its middle there, face up, turned and slanted by chance."""
    face_up = Rotation.from_euler("x", 180, degrees=True)
    turn = Rotation.from_euler("z", random.uniform(0, 360), degrees=True)
    way, slant = random.uniform(0, 2 * np.pi), np.radians(random.uniform(*STAND_SLANT_DEG))
    pose = np.eye(4)
    pose[:3, :3] = (
        Rotation.from_rotvec(slant * np.array([np.cos(way), np.sin(way), 0])) * turn * face_up
    ).as_matrix()
    pose[:3, 3] = middle - pose[:3, :3] @ middle_in_board
    return pose
