"""Corners from the edges of all squares: a homography that fits the near/far picture best, then each corner."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.near_far import NearFar
from elbowroom.geometry import Intrinsics

Array = NDArray[np.float64]
EDGE_PX = 0.6
"""Half width of an edge in the fit, as the sigma of a blur [px]."""
ROUNDS = 12
LOCAL_ROUNDS = 3
LEAST_LOCAL_PX = 7.0
"""Squares below this get no corners of their own: their edges are too few, the homography of all says it better."""
LEAST_AGREEMENT = 0.72
"""Of the pattern when it was fitted; boards of other sizes reach 0.5."""
MOST_SHIFT = 0.2
"""A corner that moves by more than this share of a square is not believed."""


class Fit(NamedTuple):
    """What the edges say.

    Fields:
        image_from_board: homography from the board's plane [m] to (X/Z, Y/Z), shape (3, 3).
        corners: (X/Z, Y/Z) of all corners, shape (n, 2).
        covariance: of each corner as if it stood alone, in (X/Z, Y/Z), shape (n, 2, 2).
        board_x, board_y: where each pixel's ray meets the board [m], shape (rows, columns).
        agreement: share of the pixels within the pattern that are as it says, less those that are not.
        residual: root mean square of what the pattern does not explain at edges; 0.29: edges sampled at points.
        square_px: edge of a square in the image, about [px].
    """

    image_from_board: Array
    corners: Array
    covariance: Array
    board_x: Array
    board_y: Array
    residual: float
    agreement: float
    square_px: float

    def sigma_px(self, intrinsics: Intrinsics) -> Array:
        """Standard deviation of each corner, mean of both directions, shape (n,) [px]."""
        variance = intrinsics.fx**2 * self.covariance[:, 0, 0] + intrinsics.fy**2 * self.covariance[:, 1, 1]
        return np.asarray(np.sqrt(variance / 2))


class _Edges(NamedTuple):
    """Pixels at edges: where they lie on the board, what the pattern says, and how that changes with place."""

    x: Array
    y: Array
    x_px: Array
    y_px: Array
    near: Array
    value: Array
    by_x: Array
    by_y: Array
    residual: Array


def edges_fitted(
    picture: NearFar, board: Board, image_from_board: Array, pixel: tuple[float, float]
) -> Fit | None:
    """Fits the pattern's edges.

    Args:
        picture: near and far.
        board: the board.
        image_from_board: homography from the board's plane [m] to (X/Z, Y/Z), about, shape (3, 3).
        pixel: size of a pixel in X/Z and Y/Z, about.

    Returns:
        None: too few pixels, or no fit.
    """
    back = np.linalg.inv(image_from_board / image_from_board[2, 2])
    back /= back[2, 2]
    rays = np.stack([picture.x, picture.y, np.ones_like(picture.x)], axis=-1)
    damping = 1e-3
    edges = _edges(picture, board, back, rays, pixel)
    if edges is None:
        return None
    for _ in range(ROUNDS):
        used, found = edges
        jacobian = _by_homography(found, rays[used], back)
        normal = jacobian.T @ jacobian
        step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), jacobian.T @ found.residual)
        tried = back.copy()
        tried.flat[:8] += step
        attempt = _edges(picture, board, tried, rays, pixel)
        if attempt is None:
            return None
        if np.mean(attempt[1].residual ** 2) < np.mean(found.residual**2) * (1 + 1e-9):
            gain = 1 - np.mean(attempt[1].residual ** 2) / max(float(np.mean(found.residual**2)), 1e-12)
            back, edges, damping = tried, attempt, damping / 10
            if gain < 1e-5:
                break
        else:
            damping *= 20
    return _result(picture, board, back, rays, edges, pixel)


def _board_places(back: Array, rays: Array) -> tuple[Array, Array, Array]:
    at = rays @ back.T
    depth = np.where(np.abs(at[..., 2]) < 1e-9, np.nan, at[..., 2])
    return at[..., 0] / depth, at[..., 1] / depth, depth


def _edges(
    picture: NearFar, board: Board, back: Array, rays: Array, pixel: tuple[float, float]
) -> tuple[NDArray[np.bool_], _Edges] | None:
    """The pixels within the pattern, less its outer edge and its mark."""
    x, y, _ = _board_places(back, rays)
    with np.errstate(invalid="ignore"):
        x_px, y_px = _pixel_on_board(x), _pixel_on_board(y)
        s = board.square_m
        used = picture.known & (x > -s + 1.5 * x_px) & (x < board.columns * s - 1.5 * x_px)
        used &= (y > -s + 1.5 * y_px) & (y < board.rows * s - 1.5 * y_px)
        if board.marked:
            half = s / 4
            used &= (np.abs(x + s / 2) > half + x_px) | (np.abs(y + s / 2) > half + y_px)
    if used.sum() < 24:
        return None
    x, y, x_px, y_px = x[used], y[used], x_px[used], y_px[used]
    return used, _compared(board, x, y, x_px, y_px, picture.near[used])


def _compared(board: Board, x: Array, y: Array, x_px: Array, y_px: Array, near: Array) -> _Edges:
    across, across_slope = _wave(x, board.square_m, board.columns, EDGE_PX * x_px)
    down, down_slope = _wave(y, board.square_m, board.rows, EDGE_PX * y_px)
    value = 0.5 + 0.5 * across * down
    by_x, by_y = 0.5 * across_slope * down, 0.5 * across * down_slope
    return _Edges(
        x=x, y=y, x_px=x_px, y_px=y_px, near=near, value=value, by_x=by_x, by_y=by_y, residual=near - value
    )


def _pixel_on_board(place: Array) -> Array:
    """How far the place on the board moves from pixel to pixel [m]."""
    down, right = np.gradient(place)
    return np.maximum(np.hypot(down, right), 1e-9)


def _wave(place: Array, square_m: float, lines: int, blur_m: Array) -> tuple[Array, Array]:
    """-1 before the first line, +1 beyond it, and so on, blurred; and its derivative."""
    line = np.clip(np.rint(place / square_m), 0, lines - 1)
    sign = np.where(line % 2 == 0, 1.0, -1.0)
    t = (place - line * square_m) / (np.sqrt(2) * blur_m)
    return sign * erf(t), sign * 2 / np.sqrt(np.pi) * np.exp(-(t**2)) / (np.sqrt(2) * blur_m)


def _by_homography(edges: _Edges, rays: Array, back: Array) -> Array:
    """Derivative of the pattern at each pixel by the first eight entries of the homography, shape (n, 8)."""
    depth = rays @ back[2]
    x_part, y_part = edges.by_x / depth, edges.by_y / depth
    last = -(edges.by_x * edges.x + edges.by_y * edges.y) / depth
    return np.concatenate(
        [x_part[:, None] * rays, y_part[:, None] * rays, last[:, None] * rays[:, :2]], axis=1
    )


def _result(
    picture: NearFar,
    board: Board,
    back: Array,
    rays: Array,
    edges: tuple[NDArray[np.bool_], _Edges],
    pixel: tuple[float, float],
) -> Fit | None:
    _, found = edges
    slope = np.hypot(found.by_x, found.by_y)
    at_edge = slope > 0.2 * np.quantile(slope, 0.98)
    residual = float(np.sqrt(np.mean(found.residual[at_edge] ** 2)))
    contrast = 2 * found.value - 1
    agreement = float((contrast * (2 * found.near - 1)).mean() / (contrast**2).mean())
    forward: Array = np.linalg.inv(back).astype(np.float64)
    corners = board.corners_in_board[:, :2].copy()
    square_px = _square_px(forward, board, pixel)
    rounds = LOCAL_ROUNDS if square_px >= LEAST_LOCAL_PX else 1
    shifts, covariance = _local(found, board, corners, residual, rounds)
    if square_px >= LEAST_LOCAL_PX:
        if np.abs(shifts).max() > MOST_SHIFT * board.square_m:
            return None
        corners = corners + shifts
    placed = np.column_stack([corners, np.ones(len(corners))]) @ forward.T
    seen = placed[:, :2] / placed[:, 2:]
    local = (forward[None, :2, :2] - seen[:, :, None] * forward[None, 2:, :2]) / placed[:, 2][:, None, None]
    x, y, _ = _board_places(back, rays)
    return Fit(
        forward, seen, local @ covariance @ local.transpose(0, 2, 1), x, y, residual, agreement, square_px
    )


def _square_px(forward: Array, board: Board, pixel: tuple[float, float]) -> float:
    """Shorter edge of the square in the board's middle [px]."""
    s = board.square_m
    middle = np.array([(board.columns - 1) * s / 2, (board.rows - 1) * s / 2, 1.0])
    ends = np.stack([middle, middle + (s, 0, 0), middle + (0, s, 0)]) @ forward.T
    ends = ends[:, :2] / ends[:, 2:] / np.array(pixel)
    return float(np.linalg.norm(ends[1:] - ends[0], axis=1).min())


def _local(edges: _Edges, board: Board, corners: Array, residual: float, rounds: int) -> tuple[Array, Array]:
    """By how much each corner's four edges want it moved on the board [m], and the covariance of that."""
    shifts, covariances = np.zeros_like(corners), np.zeros((len(corners), 2, 2))
    half, weakest = board.square_m / 2, np.eye(2) * 1e-6 / board.square_m**2
    for n, (cx, cy) in enumerate(corners):
        mine = (np.abs(edges.x - cx) < half) & (np.abs(edges.y - cy) < half)
        x, y, x_px, y_px, near = (values[mine] for values in edges[:5])
        for _ in range(rounds):
            there = _compared(board, x - shifts[n, 0], y - shifts[n, 1], x_px, y_px, near)
            jacobian = -np.column_stack([there.by_x, there.by_y])
            normal = jacobian.T @ jacobian + weakest
            shifts[n] += np.linalg.solve(normal, jacobian.T @ there.residual)
        covariances[n] = residual**2 * np.linalg.inv(normal)
    return shifts, covariances
