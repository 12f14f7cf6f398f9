"""Where in a plane a board of known size lies: its pattern laid over the near/far picture, all turns and places."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.ndimage import gaussian_filter

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.near_far import NearFar
from elbowroom.calibrate.boards.plate import Plate
from elbowroom.extras import package
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import distorted

Array = NDArray[np.float64]
CELLS = 6
"""Per square."""
SMALL_TURNS_DEG = (0.0, -3.5, 3.5)
BLUR_CELLS = 1.2
RING_SQUARES = 0.5
"""Beyond the plate nothing may be near for so many squares."""
MARK_SHARE = 0.5


class Registration(NamedTuple):
    """A board laid over the picture.

    Fields:
        camera_from_board: pose, shape (4, 4).
        score: 1: all pixels are as the pattern says, 0: as if by chance.
        known: share of the pattern where the picture says anything.
    """

    camera_from_board: Array
    score: float
    known: float


def registered(
    picture: NearFar, plate: Plate, camera: DepthCamera, board: Board, scale: float = 1.0
) -> Registration:
    """The best of all places and turns.

    Args:
        picture: near and far.
        plate: the plane in which the board lies.
        camera: with its intrinsics.
        board: the board.
        scale: for a board whose squares are so much larger than `board` says.
    """
    cell = board.square_m * scale / CELLS
    reach = float(np.linalg.norm(np.ptp(board.outline_in_board, axis=0))) * scale
    size = next_fast_len(2 * int(reach / cell) + 2, real=True)
    near, known = _raster(picture, plate.camera_from_plane, camera, cell, size)
    value, weight = rfft2(((2 * near - 1) * known).astype(np.float32)), rfft2(known.astype(np.float32))
    best: tuple[float, float, float, int, int] | None = None
    usual = _grid_angle(near, known)
    for quarter in range(4):
        for small in SMALL_TURNS_DEG:
            angle = usual + quarter * np.pi / 2 + np.radians(small)
            pattern = _pattern(board, angle, size)
            agreed = irfft2(value * np.conj(rfft2(pattern)), s=(size, size))
            asked = irfft2(weight * np.conj(rfft2(np.abs(pattern))), s=(size, size))
            whole = float(np.abs(pattern).sum())
            score = agreed / np.maximum(asked, 0.6 * whole)
            row, column = np.unravel_index(int(np.argmax(score)), score.shape)
            if best is None or score[row, column] > best[0]:
                best = (
                    float(score[row, column]),
                    float(asked[row, column] / whole),
                    angle,
                    int(row),
                    int(column),
                )
    assert best is not None
    score_, known_, angle, top, left = best
    shift = np.array([left, top], dtype=float) - size // 2
    plane_from_board = np.eye(4)
    cos, sin = np.cos(angle), np.sin(angle)
    plane_from_board[:2, :2] = (cos, -sin), (sin, cos)
    middle = board.corners_in_board.mean(axis=0)[:2] * scale
    plane_from_board[:2, 3] = shift * cell - plane_from_board[:2, :2] @ middle
    return Registration(plate.camera_from_plane @ plane_from_board, score_, known_)


def _raster(
    picture: NearFar, camera_from_plane: Array, camera: DepthCamera, cell: float, size: int
) -> tuple[Array, Array]:
    """The picture over the plane: near, and how far known, each of shape (size, size), y down."""
    along = (np.arange(size) - size // 2) * cell
    x, y = np.meshgrid(along, along)
    points = (
        np.stack([x, y, np.zeros_like(x)], axis=-1) @ camera_from_plane[:3, :3].T + camera_from_plane[:3, 3]
    )
    z = np.where(points[..., 2] > 0.05, points[..., 2], np.nan)
    with np.errstate(invalid="ignore", over="ignore"):
        u, v = distorted(camera.intrinsics, points[..., 0] / z, points[..., 1] / z)
    u = np.nan_to_num(u - picture.left, nan=-1e4).astype(np.float32)
    v = np.nan_to_num(v - picture.top, nan=-1e4).astype(np.float32)
    cv2 = package("cv2")

    def taken(image: Array) -> Array:
        return np.asarray(
            cv2.remap(
                image.astype(np.float32),
                u,
                v,
                cv2.INTER_LINEAR,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=0,
            ),
            dtype=np.float64,
        )

    known = taken(picture.known.astype(np.float64))
    near = taken(picture.near * picture.known) / np.maximum(known, 1e-6)
    return np.where(known > 0.05, near, 0.5), known


def _grid_angle(near: Array, known: Array) -> float:
    """Direction of the picture's edges up to quarter turns [rad]."""
    down, right = np.gradient(gaussian_filter(near, BLUR_CELLS))
    inside = (known > 0.99) & np.roll(known > 0.99, 1, 0) & np.roll(known > 0.99, 1, 1)
    fourfold = (((right + 1j * down) ** 4) * inside).sum()
    return float(np.angle(fourfold) / 4)


def _pattern(board: Board, angle: float, size: int) -> NDArray[np.float32]:
    """+1 on material, -1 on holes and about the plate, 0 elsewhere and on the mark; the board's middle is at (0, 0)."""
    return _drawn(board.columns, board.rows, board.border_m / board.square_m, board.marked, angle, size)


def _drawn(
    columns: int, rows: int, border: float, marked: bool, angle: float, size: int
) -> NDArray[np.float32]:
    steps = (np.fft.fftfreq(size, 1 / size) / CELLS).astype(np.float32)
    x, y = np.meshgrid(steps, steps)
    cos, sin = np.float32(np.cos(angle)), np.float32(np.sin(angle))
    bx = cos * x + sin * y + (columns - 1) / 2
    by = -sin * x + cos * y + (rows - 1) / 2
    beyond = np.maximum(np.maximum(-1 - bx, bx - columns), np.maximum(-1 - by, by - rows))
    even = (np.floor(bx) + np.floor(by)) % 2 == 0
    pattern = np.where(even, np.float32(1), np.float32(-1))
    pattern[beyond > 0] = 1.0
    pattern[beyond > border] = -1.0
    pattern[beyond > border + RING_SQUARES] = 0.0
    if marked:
        half = MARK_SHARE / 2
        pattern[(np.abs(bx + 0.5) < half) & (np.abs(by + 0.5) < half)] = 0.0
    return pattern
