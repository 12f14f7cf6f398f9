"""A printed board, seen in an infrared or colour image."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.edge_fit import LEAST_AGREEMENT, edges_fitted
from elbowroom.calibrate.boards.near_far import NearFar
from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.extras import package
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import directions, distorted
from elbowroom.sensing.rays import pixel_rays

Array = NDArray[np.float64]
LEAST_SIGMA_PX = 0.02
ON_PLATE_SIGMAS = 5.0
LEAST_DEPTHS = 20
MOST_CHANGE_PX = 1.0
FEWEST = 3
"""Corners a side that OpenCV looks for when it looks for boards of any count."""
EDGE_SHARE = 0.03
"""A board of fewer corners that comes so near to the image's edge is taken for one that is half seen."""
MARK_CONTRAST = 0.4


def printed_view(
    camera: DepthCamera,
    board: Board,
    grey: NDArray[np.uint8],
    depth_m: NDArray[np.floating] | None,
    pose: int,
    stamp_ns: int | None = None,
) -> BoardView | Trouble:
    """The view of a printed board, or why there is none.

    OpenCV's sector-based detector finds the corners (Duda and Frese, "Accurate Detection and Localization of
    Checkerboard Corners for Calibration", BMVC 2018). `corner_sigma_px`, one for all, is
    by how much they scatter about a smooth surface over the board.

    Args:
        camera: that took the image.
        board: printed.
        grey: the image, shape (h, w).
        depth_m: depth image of the same pixels, shape (h, w) [m, the camera's kind]; None: there is none.
        pose: number of the board's pose.
        stamp_ns: time of exposure [ns].
    """
    found = _found(grey, board)
    if found is None:
        return Trouble(camera.name, pose, *_why_not(grey, board))
    stretched, corners = found
    turned = _from_first(stretched, corners, board)
    if turned is None:
        return Trouble(
            camera.name, pose, Fault.NOT_SEEN, "its first square is not dark, or cannot be made out"
        )
    corners = turned
    if board.marked:
        contrast = _mark_contrast(stretched, corners, board)
        if contrast < -MARK_CONTRAST:
            return Trouble(camera.name, pose, Fault.MIRRORED)
        if contrast < MARK_CONTRAST:
            return Trouble(camera.name, pose, Fault.NOT_SEEN, "its mark cannot be made out")
    pixels, depths = points_within(camera, corners, depth_m)
    scatter = _scatter(corners)
    refined = _refined(camera, board, grey, corners)
    if refined is None:
        flat, sigma = corners.reshape(-1, 2), np.full(corners[..., 0].size, scatter)
    else:
        flat = refined[0]
        sigma = np.maximum(refined[1], _scatter(flat.reshape(corners.shape)))
    return BoardView(
        camera=camera.name,
        pose=pose,
        corner_ids=np.arange(len(flat)),
        corners_px=flat,
        corner_sigma_px=np.maximum(sigma, LEAST_SIGMA_PX),
        plane_px=pixels,
        plane_depth_m=depths,
        stamp_ns=stamp_ns,
    )


def _found(grey: NDArray[np.uint8], board: Board) -> tuple[NDArray[np.uint8], Array] | None:
    """The image in which they were found, and corners as OpenCV orders them, shape (rows, columns, 2) [px].

    An image whose board is nearly black, far from the lamp, needs its local contrast raised; others are better without.
    """
    cv2 = package("cv2")
    raised = cv2.createCLAHE(clipLimit=4.0, tileGridSize=(8, 8)).apply(grey)
    thorough = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
    for image, flags in ((grey, cv2.CALIB_CB_ACCURACY), (grey, thorough), (raised, thorough)):
        found, corners = cv2.findChessboardCornersSB(image, (board.columns, board.rows), flags=flags)
        if found:
            return image, np.asarray(corners, dtype=float).reshape(board.rows, board.columns, 2)
    return None


def _refined(
    camera: DepthCamera, board: Board, grey: NDArray[np.uint8], corners: Array
) -> tuple[Array, Array] | None:
    """The corners by their four edges, shape (n, 2) [px], and the sigma of each; None: the edges fit no pattern.

    OpenCV's corners are off by a few hundredths of a pixel, all to the same side.
    """
    intrinsics = camera.intrinsics
    flat = corners.reshape(-1, 2)
    seen = directions(intrinsics, flat, f"camera {camera.name}")
    image_from_board = np.asarray(package("cv2").findHomography(board.corners_in_board[:, :2], seen)[0])
    picture = _as_near_far(camera, board, grey, image_from_board, flat)
    fit = edges_fitted(picture, board, image_from_board, (1 / intrinsics.fx, 1 / intrinsics.fy))
    if fit is None or fit.agreement < LEAST_AGREEMENT:
        return None
    u, v = distorted(intrinsics, fit.corners[:, 0], fit.corners[:, 1])
    refined = np.column_stack([u, v])
    if np.abs(refined - flat).max() > MOST_CHANGE_PX:
        return None
    return refined, fit.sigma_px(intrinsics)


def _as_near_far(
    camera: DepthCamera, board: Board, grey: NDArray[np.uint8], image_from_board: Array, corners: Array
) -> NearFar:
    """The image about the board with dark squares 1 and bright ones 0, however the light falls."""
    rays = pixel_rays(camera)
    span = 0.2 * np.ptp(corners, axis=0) + 3
    low = np.maximum(np.floor(corners.min(axis=0) - span).astype(int), 0)
    high = np.ceil(corners.max(axis=0) + span).astype(int) + 1
    part = (slice(low[1], high[1]), slice(low[0], high[0]))
    x, y = rays.x[part].astype(float), rays.y[part].astype(float)
    at = np.stack([x, y, np.ones_like(x)], axis=-1) @ np.linalg.inv(image_from_board).T
    bx, by = at[..., 0] / at[..., 2] / board.square_m, at[..., 1] / at[..., 2] / board.square_m
    column, row = np.floor(bx), np.floor(by)
    on_board = (column >= -1) & (column < board.columns) & (row >= -1) & (row < board.rows)
    middle = on_board & (np.abs(bx - column - 0.5) < 0.3) & (np.abs(by - row - 0.5) < 0.3)
    if board.marked:
        middle &= (column > -1) | (row > -1)
    dark = (column + row) % 2 == 0
    values = grey[part].astype(float)
    basis = np.stack([np.ones_like(bx), bx, by, bx * bx, bx * by, by * by], axis=-1)

    def light(of: NDArray[np.bool_]) -> Array:
        found = np.linalg.lstsq(basis[of], values[of], rcond=None)[0]
        return np.asarray(basis @ found, dtype=np.float64)

    ink, paper = light(middle & dark), light(middle & ~dark)
    near = np.clip((paper - values) / np.maximum(paper - ink, 1.0), -0.3, 1.3)
    return NearFar(int(low[1]), int(low[0]), near, on_board, x, y, np.zeros_like(x))


def _why_not(grey: NDArray[np.uint8], board: Board) -> tuple[Fault, str]:
    """What is there instead of the board: nothing, a part of it, or a board of another count."""
    cv2 = package("cv2")
    flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_LARGER
    found, corners, layout = cv2.findChessboardCornersSBWithMeta(grey, (FEWEST, FEWEST), flags)
    if not found:
        return Fault.NOT_SEEN, ""
    rows, columns = layout.shape
    said = f"{columns} x {rows} corners instead of {board.columns} x {board.rows}"
    places = np.asarray(corners, dtype=float).reshape(-1, 2)
    height, width = grey.shape
    square = float(np.median(np.linalg.norm(np.diff(places[:columns], axis=0), axis=1)))
    margin = max(1.6 * square, EDGE_SHARE * width)
    near_edge = (places.min(axis=0) < margin).any() or (
        places.max(axis=0) > (width - margin, height - margin)
    ).any()
    # less than the board, and at the image's edge: the rest is beyond it
    fewer = rows * columns < board.rows * board.columns
    return (Fault.HALF_SEEN if near_edge and fewer else Fault.WRONG_COUNT), said


def _from_first(grey: NDArray[np.uint8], corners: Array, board: Board) -> Array | None:
    """The corners in the board's own order: x by y right-handed as in the image, the first square dark."""
    along = (corners[:, -1] - corners[:, 0]).mean(axis=0)
    down = (corners[-1] - corners[0]).mean(axis=0)
    if along[0] * down[1] - along[1] * down[0] < 0:
        corners = corners[:, ::-1]
    homography = _homography(board, corners)
    contrast = _square_grey(grey, homography, board, 0, 0) - _square_grey(grey, homography, board, 1, 0)
    middle = np.ptp([_square_grey(grey, homography, board, c, 0) for c in (0, 1)])
    if middle < 5:
        return None
    return corners if contrast < 0 else corners[::-1, ::-1]


def _homography(board: Board, corners: Array) -> Array:
    """From the board's plane, in squares, to pixels."""
    places = board.corners_in_board[:, :2] / board.square_m
    return np.asarray(package("cv2").findHomography(places, corners.reshape(-1, 2))[0])


def _square_grey(grey: NDArray[np.uint8], homography: Array, board: Board, column: int, row: int) -> float:
    """Mean grey of the middle of the square beyond corner (column, row), between inner corners."""
    return _grey_at(grey, homography, column + 0.5, row + 0.5, 0.2)


def _grey_at(grey: NDArray[np.uint8], homography: Array, x: float, y: float, half: float) -> float:
    steps = np.linspace(-half, half, 5)
    at = np.stack([*np.meshgrid(x + steps, y + steps), np.ones((5, 5))], axis=-1) @ homography.T
    u, v = (at[..., :2] / at[..., 2:]).transpose(2, 0, 1)
    u = np.clip(np.rint(u), 0, grey.shape[1] - 1).astype(int)
    v = np.clip(np.rint(v), 0, grey.shape[0] - 1).astype(int)
    return float(grey[v, u].mean())


def _mark_contrast(grey: NDArray[np.uint8], corners: Array, board: Board) -> float:
    """How much brighter the mark's place is than where a mirror would put it, over the board's own contrast."""
    homography = _homography(board, corners)
    contrast = abs(_square_grey(grey, homography, board, 0, 0) - _square_grey(grey, homography, board, 1, 0))
    here, there = (
        _grey_at(grey, homography, float(x), float(y), 0.15)
        for x, y, _ in (board.mark_in_board / board.square_m, board.mirrored_mark_in_board / board.square_m)
    )
    return (here - there) / max(contrast, 1.0)


def _scatter(corners: Array) -> float:
    """Standard deviation of corners about a homography and a cubic surface over the board [px]."""
    rows, columns = corners.shape[:2]
    x, y = np.meshgrid(np.linspace(-1, 1, columns), np.linspace(-1, 1, rows))
    places = np.stack([x, y], axis=-1).reshape(-1, 2)
    seen = corners.reshape(-1, 2)
    homography, _ = package("cv2").findHomography(places, seen)
    at = np.column_stack([places, np.ones(len(places))]) @ homography.T
    left = seen - at[:, :2] / at[:, 2:]
    powers = [(a, b) for a in range(4) for b in range(4 - a)]
    basis = np.column_stack([places[:, 0] ** a * places[:, 1] ** b for a, b in powers])
    if len(places) < 2 * len(powers):
        basis = basis[:, :0]
    # the homography has taken eight of the numbers, and the cubic surface more: all that it has
    explained = basis @ np.linalg.lstsq(basis, left, rcond=None)[0] if basis.shape[1] else 0.0
    free = 2 * len(places) - (2 * basis.shape[1] or 8)
    return float(np.sqrt(((left - explained) ** 2).sum() / max(free, 1)))


def points_within(
    camera: DepthCamera, corners: Array, depth_m: NDArray[np.floating] | None
) -> tuple[Array, Array]:
    """Pixels among the corners that have a return on the board's plane, and their depth.

    Args:
        camera: that took the depth image.
        corners: in it, shape (rows, columns, 2) [px].
        depth_m: shape (h, w) [m, the camera's kind]; None: there is none.

    Returns:
        shape (n, 2), u then v [px]; shape (n,) [m].
    """
    nothing = np.zeros((0, 2)), np.zeros(0)
    if depth_m is None:
        return nothing
    cv2 = package("cv2")
    hull = np.rint(np.stack([corners[0, 0], corners[0, -1], corners[-1, -1], corners[-1, 0]])).astype(
        np.int32
    )
    mask = np.zeros(depth_m.shape, np.uint8)
    cv2.fillConvexPoly(mask, hull, 1)
    z = np.asarray(depth_m, dtype=float)
    rows, columns = np.nonzero(
        (mask > 0) & np.isfinite(z) & (z > max(camera.min_depth_m, 0)) & (z <= camera.deepest_m)
    )
    if len(rows) < LEAST_DEPTHS:
        return nothing
    # inverse depth of a plane is linear over the image, but for the lens: enough to tell what is not on the board
    basis = np.column_stack([columns, rows, np.ones(len(rows))])
    inverse = 1 / z[rows, columns]
    keep = np.ones(len(rows), dtype=bool)
    for _ in range(3):
        fitted = basis @ np.linalg.lstsq(basis[keep], inverse[keep], rcond=None)[0]
        off = inverse - fitted
        spread = 1.4826 * float(np.median(np.abs(off[keep]))) + 1e-6
        keep = np.abs(off) < ON_PLATE_SIGMAS * spread
    return np.column_stack([columns, rows])[keep].astype(float), z[rows, columns][keep]
