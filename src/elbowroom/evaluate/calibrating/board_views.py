"""Views of a board by projection: what detection would hand on, with known truth."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.calibrate import Board, BoardView
from elbowroom.calibrate.extrinsics.anchor import POINT_SIGMA_M, BoardCorner
from elbowroom.geometry import DepthCamera, Intrinsics, looking_at
from elbowroom.geometry.lens import distorted
from elbowroom.sensing import NOISE_PRESETS, NoiseModel

Array = NDArray[np.float64]
BOARD = Board(8, 5, 0.08, "cut_out")


def ring(
    count: int,
    width: int = 640,
    hfov_deg: float = 70.0,
    noise: NoiseModel | None = NOISE_PRESETS["kinect_v1"],
    **more: Any,
) -> tuple[DepthCamera, ...]:
    """Cameras about a room of 4 x 4 m that look at its middle.

    Args:
        count: how many.
        width: of their images [px].
        hfov_deg: horizontal field of view [deg].
        noise: of their depth; None: exact.
        more: further arguments of `DepthCamera`.
    """
    f = width / 2 / np.tan(np.radians(hfov_deg / 2))
    height = width * 3 // 4
    lens = Intrinsics(f, f, (width - 1) / 2, (height - 1) / 2, more.pop("distortion", ()))
    angles = np.arange(count) * 2 * np.pi / count + 0.1
    return tuple(
        DepthCamera(
            f"cam-{n}",
            width,
            height,
            looking_at((1.9 * np.cos(a), 1.9 * np.sin(a), 2.3), (0.1 * n / count, 0.0, 1.0)),
            lens,
            noise=noise,
            **more,
        )
        for n, a in enumerate(angles)
    )


@dataclass(frozen=True)
class Shaken:
    """What is added to exact views: errors of corners and depth, common ones of a whole view, a hand that shakes."""

    corner_px: float = 0.1
    depth: float = 1.0
    view_px: float = 0.0
    view_depth_m: float = 0.0
    hand_m: float = 0.0


ROUGH = Shaken()
EXACT = Shaken(0.0, 0.0)


def floor() -> Array:
    """world_from_board of the board that lies on the floor, its face up, shape (4, 4)."""
    world_from_board = np.diag([1.0, -1.0, -1.0, 1.0])
    world_from_board[:3, 3] = (-0.3, 0.2, 0.02)
    return world_from_board


def board_poses(count: int, rng: np.random.Generator) -> list[Array]:
    """The board on the floor, then held up anywhere, mostly face up so that cameras all around see its face."""
    poses = [floor()]
    for _ in range(count - 1):
        pose = np.eye(4)
        face_up = Rotation.from_euler("x", 180, degrees=True)
        tilt = Rotation.from_euler("xyz", [*rng.uniform(-40, 40, 2), rng.uniform(-180, 180)], degrees=True)
        pose[:3, :3] = (tilt * face_up).as_matrix()
        middle = np.array([*rng.uniform(-0.8, 0.8, 2), rng.uniform(0.3, 1.4)])
        pose[:3, 3] = middle - pose[:3, :3] @ BOARD.corners_in_board.mean(axis=0)
        poses.append(pose)
    return poses


def measured_corners(
    poses: Sequence[Array],
    which: Sequence[int],
    rng: np.random.Generator,
    sigma_m: float = POINT_SIGMA_M,
    board: Board = BOARD,
) -> tuple[BoardCorner, ...]:
    """First corner, end of its row and end of its column in each of these poses, as somebody measures them.

    Args:
        poses: world_from_board, shape (4, 4) each.
        which: numbers of the poses that are measured.
        rng: of the errors.
        sigma_m: of each coordinate [m].
        board: that stands there.
    """
    return tuple(
        BoardCorner(
            f"stand {pose}, corner {number}",
            (poses[pose] @ np.append(board.corners_in_board[number], 1))[:3] + rng.normal(0, sigma_m, 3),
            pose,
            board.corners_in_board[number],
        )
        for pose in which
        for number in (0, board.columns - 1, board.columns * (board.rows - 1))
    )


def views_of(
    cameras: Sequence[DepthCamera],
    poses: Sequence[Array],
    rng: np.random.Generator,
    shaken: Shaken = ROUGH,
    board: Board = BOARD,
    sigma_px: float | None = None,
) -> list[BoardView]:
    """What each camera sees of each pose, if it sees all of the board's face within 68 degrees of straight on.

    Args:
        cameras: that look.
        poses: world_from_board, shape (4, 4) each.
        rng: of the errors.
        shaken: how the hand moves between exposures, and what all views share.
        board: that is held.
        sigma_px: what the views say of their corners [px]; None: what is true.
    """
    views = []
    for pose, world_from_board in enumerate(poses):
        for camera in cameras:
            at = camera.camera_from_world @ world_from_board
            at = at.copy()
            at[:3, 3] += rng.normal(0, shaken.hand_m, 3) if shaken.hand_m else 0.0
            view = _view(camera, at, pose, rng, shaken, board, sigma_px)
            if view is not None:
                views.append(view)
    return views


def _view(
    camera: DepthCamera,
    at: Array,
    pose: int,
    rng: np.random.Generator,
    shaken: Shaken,
    board: Board,
    sigma_px: float | None,
) -> BoardView | None:
    points = board.corners_in_board @ at[:3, :3].T + at[:3, 3]
    middle = points.mean(axis=0)
    if points[:, 2].min() < 0.3 or at[:3, 2] @ middle / np.linalg.norm(middle) < np.cos(np.radians(68)):
        return None
    pixels = np.stack(
        distorted(camera.intrinsics, points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]), axis=1
    )
    if (pixels < 1).any() or (pixels > (camera.width - 2, camera.height - 2)).any():
        return None
    # depth at points of the board's material, which are seen at the pixels that they project to
    side = (np.arange(24) + 0.5) / 24
    x, y = (
        g.ravel()
        for g in np.meshgrid(side * board.columns * board.square_m, side * board.rows * board.square_m)
    )
    on_board = np.stack([x, y, 0 * x], axis=1) @ at[:3, :3].T + at[:3, 3]
    seen_at = np.stack(
        distorted(camera.intrinsics, on_board[:, 0] / on_board[:, 2], on_board[:, 1] / on_board[:, 2]), axis=1
    )
    depth = on_board[:, 2] if camera.depth_kind == "planar" else np.linalg.norm(on_board, axis=1)
    sigma = camera.noise.sigma(depth) if camera.noise is not None else np.zeros(len(depth))
    depth = (
        depth + shaken.depth * rng.normal(0, 1, len(depth)) * sigma + rng.normal(0, 1) * shaken.view_depth_m
    )
    pixels = pixels + rng.normal(0, 1, pixels.shape) * shaken.corner_px + rng.normal(0, 1, 2) * shaken.view_px
    stated = sigma_px if sigma_px is not None else max(shaken.corner_px, 0.05)
    ids = np.arange(len(pixels))
    return BoardView(camera.name, pose, ids, pixels, np.full(len(ids), stated), seen_at, depth)
