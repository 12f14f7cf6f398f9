"""Where somebody holds the board for one camera's intrinsics: near, tilted, and out to the corners of its image."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.calibrate.board import Board
from elbowroom.calibrate.lens import project
from elbowroom.calibrate.simulated.hand_poses import facing, in_room, shown
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera
from elbowroom.simulate.furniture import HALF_SIDE_M

SHARE = (0.4, 0.7)
"""Of the image's width that the board's longer side takes, held square before the middle of the image."""
TILT_DEG = (20.0, 45.0)
TRIES = 40
"""Poses that are drawn for each that is taken."""
MOST_TRIES = 4000
TILES = 8
"""The image is counted in so many by so many tiles."""


def near_poses(
    camera: DepthCamera,
    board: Board,
    count: int,
    random: np.random.Generator,
    half_side_m: float = HALF_SIDE_M,
) -> list[NDArray[np.float64]]:
    """Poses of a board that is held near before one camera, whole in its image.

    The board fills about half to two thirds of the image's width, is tilted by 20 to 45 degrees against the line of
    sight, each time another way, and of several draws the one is taken whose corners lie where the fewest were so far.

    Args:
        camera: with its true pose and lens.
        board: the board.
        count: number of poses.
        random: source of randomness.
        half_side_m: the walls' distance from the room's middle [m].

    Returns:
        world_from_board, each of shape (4, 4).

    Raises:
        CalibrationError: no room before the camera where the board fits.
    """
    seen = np.zeros((TILES, TILES))
    poses: list[NDArray[np.float64]] = []
    for _ in range(count):
        best, most, drawn = None, -1.0, 0
        for _ in range(MOST_TRIES):
            pose = _drawn(camera, board, random)
            if not in_room(board, pose, half_side_m) or not shown(camera, board, pose).whole:
                continue
            worth = float((1 / (1 + seen[_tiles(camera, board, pose)])).sum())
            if worth > most:
                best, most = pose, worth
            drawn += 1
            if drawn == TRIES:
                break
        if best is None:
            raise CalibrationError(
                f"camera {camera.name}: no place near before it where a board of {board.columns} x {board.rows} "
                f"squares of {board.square_m} m fits; make it smaller"
            )
        np.add.at(seen, _tiles(camera, board, best), 1)
        poses.append(best)
    return poses


def _drawn(camera: DepthCamera, board: Board, random: np.random.Generator) -> NDArray[np.float64]:
    """The board near before the camera: a place of its image, a share of its width, a tilt and a turn."""
    k = camera.intrinsics
    longer_m = float(np.ptp(board.outline_in_board, axis=0).max())
    z = longer_m * k.fx / (random.uniform(*SHARE) * camera.width)
    u, v = random.uniform(0, camera.width), random.uniform(0, camera.height)
    middle = np.array([(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z])
    turn = random.uniform(0, 2 * np.pi)
    axis = np.array([np.cos(turn), np.sin(turn), 0])
    tilt = Rotation.from_rotvec(np.radians(random.uniform(*TILT_DEG)) * axis)
    roll = Rotation.from_euler("z", random.normal(0, 20) + 90 * random.integers(0, 4), degrees=True)
    camera_from_board = np.eye(4)
    camera_from_board[:3, :3] = (facing(middle) * tilt * roll).as_matrix()
    camera_from_board[:3, 3] = middle - camera_from_board[:3, :3] @ board.corners_in_board.mean(axis=0)
    return camera.world_from_camera @ camera_from_board


def _tiles(
    camera: DepthCamera, board: Board, pose: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row and column of the tile that each corner lies in."""
    camera_from_board = camera.camera_from_world @ pose
    corners = board.corners_in_board @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
    pixels, _ = project(camera.intrinsics, corners)
    tile = np.floor(TILES * (pixels + 0.5) / (camera.width, camera.height)).astype(np.int64)
    tile = np.clip(tile, 0, TILES - 1)
    return tile[:, 1], tile[:, 0]
