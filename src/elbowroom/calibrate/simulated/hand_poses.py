"""Where somebody holds the board: places and tilts over the room such that every camera gets to see it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.calibrate.boards.board import Board
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.geometry.lens import distorted
from elbowroom.simulate.board_plate import LEAST_THICKNESS_M
from elbowroom.simulate.furniture import CEILING_M, HALF_SIDE_M

TRIES = 25
"""Poses that are drawn for each that is taken."""
MOST_TRIES = 4000
CLEARANCE_M = 0.08
"""From walls, floor and ceiling [m]."""
MOST_INCIDENCE_DEG = 60.0
"""Beyond this angle between the board's normal and the line of sight, a view does not count."""
LEAST_SQUARE_PX = 2.6
EDGE_PX = 2.0
TILT_DEG = 38.0
NEAR_FILLS = (0.9, 1.6)
"""Distance of a board that is held near, over that at which its diagonal is as long as the image is wide."""
NEAR_TILT_DEG = (20.0, 45.0)
FEET_M = 0.25
"""A board that is cut out stands on feet this high when it lies: through its holes depth must differ [m]."""
FLOOR_PLACE_M = (-0.35, 0.2)
"""Where the first corner lies on the floor [m]."""


class Shown(NamedTuple):
    """What a camera has of a board at a pose, by geometry alone.

    Fields:
        whole: all of the plate lies in the image, near and square enough to be read.
        any_part: some corner lies in the image.
        front: it sees the face.
    """

    whole: bool
    any_part: bool
    front: bool


def shown(camera: DepthCamera, board: Board, world_from_board: NDArray[np.float64]) -> Shown:
    """What a camera has in view of the board.

    Args:
        camera: with its true pose.
        board: the board.
        world_from_board: its pose, shape (4, 4).
    """
    camera_from_board = camera.camera_from_world @ world_from_board
    points = np.concatenate([board.outline_in_board, board.corners_in_board])
    points = points @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
    front = bool(invert_rigid(camera_from_board)[2, 3] < 0)
    if points[:, 2].min() < 0.2:
        return Shown(False, False, front)
    u, v = distorted(camera.intrinsics, points[:, 0] / points[:, 2], points[:, 1] / points[:, 2])
    inside = (
        (u > EDGE_PX) & (u < camera.width - 1 - EDGE_PX) & (v > EDGE_PX) & (v < camera.height - 1 - EDGE_PX)
    )
    middle = points.mean(axis=0)
    cosine = abs(float(camera_from_board[:3, 2] @ middle)) / float(np.linalg.norm(middle))
    size_px = board.square_m * camera.intrinsics.fx * cosine / middle[2]
    readable = cosine > np.cos(np.radians(MOST_INCIDENCE_DEG)) and size_px >= LEAST_SQUARE_PX
    return Shown(bool(inside.all()) and readable, bool(inside[4:].any()), front)


def floor_pose(board: Board) -> tuple[tuple[float, float, float], float]:
    """Place of the first corner [m, world] and direction of the x axis [deg] of the board that lies on the floor."""
    height = FEET_M if board.kind == "cut_out" else max(board.thickness_m, LEAST_THICKNESS_M)
    return (*FLOOR_PLACE_M, height), 0.0


def hand_poses(
    cameras: Sequence[DepthCamera],
    board: Board,
    count: int,
    random: np.random.Generator,
    half_side_m: float = HALF_SIDE_M,
    taken: Sequence[NDArray[np.float64]] = (),
    near: bool = False,
) -> list[NDArray[np.float64]]:
    """Poses of a board that is held up before one camera after the other, tilted and turned, all over their images.

    Of several draws the one is taken that the cameras with fewest views so far see, in parts of the image where they
    have seen it least.

    Args:
        cameras: with their true poses.
        board: the board.
        count: number of poses.
        random: source of randomness.
        half_side_m: the walls' distance from the room's middle [m].
        taken: poses that are there already, on the floor or on a stand.
        near: right before one camera each time, so that the board fills half of its image or more and is always
            tilted: what intrinsics want. Other cameras hardly see it.

    Returns:
        world_from_board, each of shape (4, 4).

    Raises:
        CalibrationError: the cameras have no place in view where the board fits.
    """
    views = {camera.name: 0 for camera in cameras}
    cells: dict[tuple[str, int, int], int] = {}
    for pose in taken:
        count_views(cameras, board, pose, views, cells)
    poses: list[NDArray[np.float64]] = []
    for number in range(count):
        best, most, drawn = None, -1.0, 0
        for _ in range(MOST_TRIES):
            camera = cameras[int(random.permutation(_neediest(views))[0])]
            pose = _drawn(camera, board, random, near)
            if not in_room(board, pose, half_side_m) or not shown(camera, board, pose).whole:
                continue
            worth = worth_of(cameras, board, pose, views, cells)
            if worth > most:
                best, most = pose, worth
            drawn += 1
            if drawn == TRIES:
                break
        if best is None:
            raise CalibrationError(
                f"pose {number}: no place in view of {cameras[0].name} and the others where a board of "
                f"{board.columns} x {board.rows} squares of {board.square_m} m fits; "
                "make it smaller, or the images larger"
            )
        count_views(cameras, board, best, views, cells)
        poses.append(best)
    return poses


def _neediest(views: dict[str, int]) -> NDArray[np.int64]:
    """Numbers of the cameras that have fewest views, up to a few more than these."""
    counts = np.array(list(views.values()))
    return np.flatnonzero(counts <= counts.min() + 1)


def _drawn(
    camera: DepthCamera, board: Board, random: np.random.Generator, near_by: bool
) -> NDArray[np.float64]:
    """The board before a camera: a place of its image, a distance, a tilt and a turn."""
    reach = float(np.linalg.norm(np.ptp(board.outline_in_board, axis=0)))
    near = max(0.5, 0.6 * reach * camera.intrinsics.fx / camera.width)
    far = min(3.2, board.square_m * camera.intrinsics.fx / LEAST_SQUARE_PX)
    least_tilt_deg, most_tilt_deg = 0.0, TILT_DEG
    if near_by:
        fills = reach * camera.intrinsics.fx / camera.width
        near, far = NEAR_FILLS[0] * fills, NEAR_FILLS[1] * fills
        least_tilt_deg, most_tilt_deg = NEAR_TILT_DEG
    z = random.uniform(near, max(far, near + 0.1))
    u, v = random.uniform(0, camera.width), random.uniform(0, camera.height)
    k = camera.intrinsics
    middle = np.array([(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z])
    tilt_deg = random.uniform(least_tilt_deg, most_tilt_deg)
    turn = random.uniform(0, 2 * np.pi)
    tilt = Rotation.from_rotvec(np.radians(tilt_deg) * np.array([np.cos(turn), np.sin(turn), 0]))
    roll = Rotation.from_euler("z", random.normal(0, 20) + 90 * random.integers(0, 4), degrees=True)
    camera_from_board = np.eye(4)
    camera_from_board[:3, :3] = (_facing(middle) * tilt * roll).as_matrix()
    camera_from_board[:3, 3] = middle - camera_from_board[:3, :3] @ board.corners_in_board.mean(axis=0)
    return camera.world_from_camera @ camera_from_board


def _facing(middle: NDArray[np.float64]) -> Rotation:
    """Turns the camera's z axis to the line of sight."""
    axis = np.array([-middle[1], middle[0], 0.0])
    across = float(np.linalg.norm(axis))
    return Rotation.from_rotvec(axis / max(across, 1e-12) * np.arctan2(across, middle[2]))


def in_room(board: Board, pose: NDArray[np.float64], half_side_m: float) -> bool:
    """Whether a board fits in the room at a pose, world_from_board of shape (4, 4), and touches nothing.

    Args:
        board: to be held.
        pose: world_from_board, shape (4, 4).
        half_side_m: of the room [m].
    """
    corners = board.outline_in_board @ pose[:3, :3].T + pose[:3, 3]
    low, high = corners.min(axis=0), corners.max(axis=0)
    side = half_side_m - CLEARANCE_M
    return bool(
        (low[:2] > -side).all()
        and (high[:2] < side).all()
        and low[2] > CLEARANCE_M
        and high[2] < CEILING_M - CLEARANCE_M
    )


def _cell(camera: DepthCamera, board: Board, pose: NDArray[np.float64]) -> tuple[str, int, int]:
    """The ninth of the image that the board's middle is in."""
    middle = camera.camera_from_world @ pose @ np.append(board.corners_in_board.mean(axis=0), 1.0)
    k = camera.intrinsics
    u, v = k.fx * middle[0] / middle[2] + k.cx, k.fy * middle[1] / middle[2] + k.cy
    return camera.name, int(np.clip(3 * u / camera.width, 0, 2)), int(np.clip(3 * v / camera.height, 0, 2))


def worth_of(
    cameras: Sequence[DepthCamera],
    board: Board,
    pose: NDArray[np.float64],
    views: dict[str, int],
    cells: dict[tuple[str, int, int], int],
) -> float:
    """How much a pose gives to cameras that have few `views` so far, or few in that ninth of the image (`cells`).

    Args:
        cameras: all of the room.
        board: to be held.
        pose: world_from_board, shape (4, 4).
        views: how many each camera has, by name.
        cells: how many of them in each ninth of its image, by name, column and row.
    """
    worth = 0.0
    for camera in cameras:
        seen = shown(camera, board, pose)
        if seen.whole and seen.front:
            worth += 1 / (1 + views[camera.name]) + 0.5 / (1 + 2 * cells.get(_cell(camera, board, pose), 0))
    return worth


def count_views(
    cameras: Sequence[DepthCamera],
    board: Board,
    pose: NDArray[np.float64],
    views: dict[str, int],
    cells: dict[tuple[str, int, int], int],
) -> None:
    """Adds a pose to the views and cells of the cameras that see it.

    Args:
        cameras: all of the room.
        board: that is held.
        pose: world_from_board, shape (4, 4).
        views, cells: as of `worth_of`; added to.
    """
    for camera in cameras:
        seen = shown(camera, board, pose)
        if seen.whole and seen.front:
            views[camera.name] += 1
            cell = _cell(camera, board, pose)
            cells[cell] = cells.get(cell, 0) + 1
