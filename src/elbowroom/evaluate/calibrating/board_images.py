"""How exactly corners of a cut-out board are found in rendered images, and whether what is said of it is true."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from elbowroom.calibrate import Board, BoardView
from elbowroom.calibrate.boards.cut_out import cut_out_view
from elbowroom.calibrate.boards.seen_board import seen_board
from elbowroom.calibrate.simulated.hand_poses import hand_poses
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import project
from elbowroom.geometry.twist import between
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import Moment, Solid, render, wall_cameras
from elbowroom.simulate.board_plate import plate_mesh
from elbowroom.simulate.furniture import shell

Array = NDArray[np.float64]
FINE = Board(8, 5, 0.1, "cut_out", 0.04, marked=True, thickness_m=0.003)
COARSE = Board(5, 4, 0.18, "cut_out", 0.04, marked=True, thickness_m=0.003)
CASES = (("vga", "kinect_v1", FINE), ("qqvga", "kinect_v1", COARSE), ("thesis", "tof", COARSE))
INSIDE = float(chi2.ppf(0.95, 6))


class Misses(NamedTuple):
    """What one view is off by.

    Fields:
        common_px: mean over its corners, shape (2,).
        within_px: standard deviation about that, both coordinates.
        said_px: median of `corner_sigma_px`.
        square: of the error of the pose by this view alone, in the stated sigmas; 6 is expected.
    """

    common_px: Array
    within_px: float
    said_px: float
    square: float


def board_image_rows(count: int = 20, seed: int = 3) -> Iterator[dict[str, Any]]:
    """For each size of image: the board rendered at so many poses, found, and compared with where it was.

    Args:
        count: poses for each size.
        seed: of poses and noise.
    """
    for size, noise, board in CASES:
        camera = wall_cameras(1, size=size, noise=NOISE_PRESETS[noise])[0]
        misses = [
            misses_of(camera, board, view, pose)
            for pose, view in seen_views(camera, board, count, seed)
            if view is not None
        ]
        common = np.array([miss.common_px for miss in misses])
        yield {
            "kind": "images",
            "case": size,
            "width": camera.width,
            "noise": noise,
            "poses": count,
            "views": len(misses),
            "bias_px": float(np.hypot(*common.mean(axis=0))),
            "bias_sigma_px": float(np.sqrt(common.var(axis=0).sum() / len(misses))),
            "common_px": float(np.sqrt((common**2).mean())),
            "within_px": float(np.sqrt(np.mean([miss.within_px**2 for miss in misses]))),
            "said_px": float(np.median([miss.said_px for miss in misses])),
            "mean_square": float(np.mean([miss.square for miss in misses])),
            "inside_pct": 100 * float(np.mean([miss.square <= INSIDE for miss in misses])),
        }


def seen_views(
    camera: DepthCamera, board: Board, count: int, seed: int
) -> Iterator[tuple[Array, BoardView | None]]:
    """The board held before a camera and looked for: its true pose, and the view; None: it was not found.

    Args:
        camera: that looks.
        board: that is held.
        count: how many poses.
        seed: of the poses and the noise.
    """
    for number, pose in enumerate(hand_poses([camera], board, count, np.random.default_rng([seed, 31]))):
        moment = Moment(float(number + 1), (*shell(), Solid("board", plate_mesh(board), pose)), {})
        frame = render([camera], moment, seed=seed)[0]
        found = cut_out_view(camera, board, frame.depth_m, number)
        yield pose, found if isinstance(found, BoardView) else None


def misses_of(camera: DepthCamera, board: Board, view: BoardView, world_from_board: Array) -> Misses:
    """A view against the truth.

    Args:
        camera: that saw it.
        board: that was held.
        view: what was seen.
        world_from_board: its true pose, shape (4, 4).
    """
    camera_from_board = camera.camera_from_world @ world_from_board
    corners = board.corners_in_board[view.corner_ids]
    points = corners @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
    off = view.corners_px - project(camera.intrinsics, points)[0]
    lone = seen_board({camera.name: camera}, board, view).lone[0]
    error = between(lone.camera_from_board, camera_from_board)
    return Misses(
        off.mean(axis=0),
        float(np.sqrt(off.var(axis=0).mean())),
        float(np.median(view.corner_sigma_px)),
        float(error @ lone.information @ error),
    )
