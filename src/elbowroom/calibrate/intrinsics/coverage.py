"""What of the image the board has covered, and what to capture next."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.geometry import DepthCamera

CELLS = 3
NAMES = (
    ("upper left corner", "upper edge", "upper right corner"),
    ("left edge", "middle", "right edge"),
    ("lower left corner", "lower edge", "lower right corner"),
)
FEW_VIEWS = 8
LITTLE_TILT_DEG = 20.0
SMALL_SHARE = 0.2


def cells_seen(camera: DepthCamera, views: Sequence[BoardView]) -> NDArray[np.int64]:
    """How many corners were seen in each ninth of the image, shape (3, 3), rows by columns."""
    counts = np.zeros((CELLS, CELLS), dtype=np.int64)
    for view in views:
        cell = np.floor(CELLS * (view.corners_px + 0.5) / (camera.width, camera.height)).astype(int)
        np.add.at(counts, tuple(np.clip(cell, 0, CELLS - 1)[:, ::-1].T), 1)
    return counts


def advice(
    camera: DepthCamera, views: Sequence[BoardView], camera_from_boards: Sequence[NDArray[np.float64]]
) -> tuple[str, ...]:
    """What is weak and what to capture next, a sentence each; empty: nothing.

    Args:
        camera: with the size of its image.
        views: of the board.
        camera_from_boards: the board's poses in these views, each of shape (4, 4).
    """
    said = []
    if len(views) < FEW_VIEWS:
        said.append(f"{camera.name}: only {len(views)} views; show the board at least {FEW_VIEWS} times")
    empty = [
        NAMES[row][column] for row, column in zip(*np.nonzero(cells_seen(camera, views) == 0), strict=True)
    ]
    if empty:
        said.append(f"{camera.name}: hold the board where it was never seen: {', '.join(empty)}")
    tilt = tilt_deg(camera_from_boards)
    if tilt < LITTLE_TILT_DEG:
        said.append(f"{camera.name}: tilt the board more, its poses differ by {tilt:.0f} degrees only")
    widest = max((np.ptp(view.corners_px[:, 0]) / camera.width for view in views), default=0.0)
    if widest < SMALL_SHARE:
        said.append(
            f"{camera.name}: come nearer, the board never takes more than {100 * widest:.0f} % of the width"
        )
    return tuple(said)


def tilt_deg(camera_from_boards: Sequence[NDArray[np.float64]]) -> float:
    """Greatest angle between the board's normals [deg]."""
    normals = np.array([pose[:3, 2] for pose in camera_from_boards])
    return float(np.degrees(np.arccos(np.clip((normals @ normals.T).min(), -1, 1))))
