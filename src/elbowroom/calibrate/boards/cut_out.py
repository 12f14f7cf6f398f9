"""A board that is cut out, seen in a depth image."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.edge_fit import EDGE_PX, LEAST_AGREEMENT, Fit, edges_fitted
from elbowroom.calibrate.boards.near_far import NearFar, cropped, near_far
from elbowroom.calibrate.boards.plate import Plate, View, plates
from elbowroom.calibrate.boards.registration import Registration, registered
from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import distorted
from elbowroom.sensing.rays import PixelRays, pixel_rays

Array = NDArray[np.float64]
LEAST_SCORE = 0.2
"""Of the pattern laid over the picture by steps of turn and place; what is below is not tried."""
LEAST_KNOWN = 0.93
"""Share of the pattern that must be seen."""
LEAST_SQUARE_PX = 2.5
"""Below, the back of a slanted plate can pass for its face: of 500 images of such a back 18 did, all but one with
squares of 2.2 to 2.4 pixels, that one with 2.51, and all else as good as in views that were right."""
MARK_CONTRAST = 0.2
OTHER_SIZES = (0.5, 0.6, 0.7, 0.8, 0.9, 1.1, 1.25, 1.4, 1.6, 1.8, 2.0)
LEAST_SIGMA_PX = 0.01
INSIDE_PX = 0.75
"""So far from every edge of material a pixel sees nothing else [px]: half its diagonal, and a little for edges that are
not quite where they were found. Of squares of three pixels each tenth of a pixel counts: at 1.1 px most had no such
pixel, and depth said little of the board's tilt. What flies all the same is not on the plate's plane."""
ON_PLATE_SIGMAS = 3.5


def cut_out_view(
    camera: DepthCamera,
    board: Board,
    depth_m: NDArray[np.floating],
    pose: int,
    stamp_ns: int | None = None,
    *,
    other_sizes: bool = False,
) -> BoardView | Trouble:
    """The view of a board that is cut out, or why there is none.

    The plate's plane is found among pixels beside holes; in that plane the pattern of known size is laid over near and
    far at all places and turns; then its edges are fitted: first all by one homography, then, where squares have at
    least 7 pixels, each corner by the four edges that meet in it. Intrinsics need be right to a few per cent only.

    `corner_sigma_px` is what a corner's own four edges tell, so that corners may be counted as independent; of small
    squares, where all edges place all corners together, each is more exact than that, but not their mean.

    Args:
        camera: with intrinsics as they are known.
        board: cut out.
        depth_m: its depth image as it was taken, shape (h, w) [m, the camera's kind of depth].
        pose: number of the board's pose.
        stamp_ns: time of exposure [ns].
        other_sizes: where no board is seen, look for one whose squares are larger or smaller, to say so; takes long.
    """
    rays = pixel_rays(camera)
    view = View(camera, rays, _planar(camera, rays, depth_m))
    reach = float(np.linalg.norm(np.ptp(board.outline_in_board, axis=0)))
    worst: Trouble | None = None
    for plate in plates(view, board.square_m, reach, np.random.default_rng(pose)):
        picture = near_far(view, plate, 0.8 * reach)
        if picture is None:
            continue
        laid = registered(picture, plate, camera, board)
        if laid.score < LEAST_SCORE:
            worst = worst or (_other_size(picture, plate, camera, board, pose) if other_sizes else None)
            continue
        if laid.known < LEAST_KNOWN or not _outline_inside(camera, board, laid.camera_from_board):
            # a smaller pattern, laid over a larger board's edge, reaches beyond what is known, too
            other = _other_size(picture, plate, camera, board, pose) if other_sizes else None
            return worst or other or Trouble(camera.name, pose, Fault.HALF_SEEN)
        found = _read(view, board, picture, laid, depth_m, pose, stamp_ns)
        if isinstance(found, BoardView) or found.fault is not Fault.NOT_SEEN:
            return found
        worst = worst or (_other_size(picture, plate, camera, board, pose) if other_sizes else None) or found
    return worst or Trouble(camera.name, pose, Fault.NOT_SEEN)


def _planar(camera: DepthCamera, rays: PixelRays, depth_m: NDArray[np.floating]) -> NDArray[np.float32]:
    """Planar depth, 0 where there is no return."""
    usable = np.isfinite(depth_m) & (depth_m >= camera.min_depth_m) & (depth_m <= camera.deepest_m)
    z = np.where(usable & (depth_m > 0), depth_m, 0.0)
    if camera.depth_kind == "radial":
        z = z / np.sqrt(1 + rays.x.astype(float) ** 2 + rays.y.astype(float) ** 2)
    return z.astype(np.float32)


def _outline_inside(camera: DepthCamera, board: Board, camera_from_board: Array) -> bool:
    points = board.outline_in_board @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
    if points[:, 2].min() <= 0.05:
        return False
    u, v = distorted(camera.intrinsics, points[:, 0] / points[:, 2], points[:, 1] / points[:, 2])
    return bool((u > -1).all() and (u < camera.width).all() and (v > -1).all() and (v < camera.height).all())


def _other_size(
    picture: NearFar, plate: Plate, camera: DepthCamera, board: Board, pose: int
) -> Trouble | None:
    """Whether the same pattern with larger or smaller squares fits well."""
    scores = {
        scale: found.score
        for scale in OTHER_SIZES
        for found in [registered(picture, plate, camera, board, scale)]
        if found.known > LEAST_KNOWN
    }
    best = max(scores, key=lambda scale: scores[scale], default=1.0)
    if scores.get(best, 0.0) < 0.5:
        return None
    return Trouble(
        camera.name,
        pose,
        Fault.WRONG_SIZE,
        f"squares of about {best * board.square_m:.3f} m instead of {board.square_m:g} m",
    )


def _read(
    view: View,
    board: Board,
    picture: NearFar,
    laid: Registration,
    depth_m: NDArray[np.floating],
    pose: int,
    stamp_ns: int | None,
) -> BoardView | Trouble:
    camera, picture = view.camera, cropped(picture, laid.camera_from_board, board.outline_in_board)
    pixel = (1 / camera.intrinsics.fx, 1 / camera.intrinsics.fy)
    fit = edges_fitted(picture, board, laid.camera_from_board[:3, [0, 1, 3]], pixel)
    if fit is None or fit.agreement < LEAST_AGREEMENT:
        return Trouble(camera.name, pose, Fault.NOT_SEEN, "its edges fit no checkerboard")
    if fit.square_px < LEAST_SQUARE_PX:
        return Trouble(
            camera.name, pose, Fault.NOT_SEEN, f"squares of {fit.square_px:.1f} pixels are too small"
        )
    if board.marked:
        contrast = _mark_contrast(board, picture, fit)
        if contrast < -MARK_CONTRAST:
            return Trouble(camera.name, pose, Fault.MIRRORED)
        if contrast < MARK_CONTRAST:
            return Trouble(camera.name, pose, Fault.NOT_SEEN, "its mark cannot be made out")
    corners = fit.corners - _half_walls(board, fit)
    u, v = distorted(camera.intrinsics, corners[:, 0], corners[:, 1])
    inside = _well_inside(board, picture, fit)
    rows, columns = np.nonzero(inside)
    rows, columns = rows + picture.top, columns + picture.left
    return BoardView(
        camera=camera.name,
        pose=pose,
        corner_ids=np.arange(len(u)),
        corners_px=np.column_stack([u, v]),
        corner_sigma_px=np.maximum(fit.sigma_px(camera.intrinsics), LEAST_SIGMA_PX),
        plane_px=np.column_stack([columns, rows]).astype(float),
        plane_depth_m=np.asarray(depth_m, dtype=float)[rows, columns],
        stamp_ns=stamp_ns,
    )


def _half_walls(board: Board, fit: Fit) -> Array:
    """By how much corners seem to lie off those of the face, because the walls of holes are seen too, shape (n, 2).

    Of the four edges that meet in a corner two are the face's and two the back's: they cross half a thickness deeper.
    """
    columns = fit.image_from_board
    size = np.sqrt(np.linalg.norm(columns[:, 0]) * np.linalg.norm(columns[:, 1]))
    x, y, origin = (columns / size).T
    if origin[2] < 0:
        x, y, origin = -x, -y, -origin
    away = np.cross(x, y)
    face = board.corners_in_board[:, :2] @ np.stack([x, y]) + origin
    deeper = face + board.thickness_m / 2 * away / np.linalg.norm(away)
    return np.asarray(deeper[:, :2] / deeper[:, 2:] - face[:, :2] / face[:, 2:])


def _mark_contrast(board: Board, picture: NearFar, fit: Fit) -> float:
    """How much farther it is in the first square's middle than in that of the square where a mirror would put it."""
    quarter = board.square_m / 4

    def hole(middle: Array) -> float:
        x, y = fit.board_x - middle[0], fit.board_y - middle[1]
        weight = _box(x, quarter) * _box(y, quarter) * picture.known
        return float((weight * (1 - picture.near)).sum() / max(float(weight.sum()), 1e-9))

    return hole(board.mark_in_board) - hole(board.mirrored_mark_in_board)


def _box(place: Array, half: float) -> Array:
    """1 within half a width of 0, blurred by a pixel."""
    down, right = np.gradient(place)
    blur = np.sqrt(2) * EDGE_PX * np.maximum(np.hypot(down, right), 1e-9)
    return np.nan_to_num(0.5 * (erf((place + half) / blur) - erf((place - half) / blur)))


def _well_inside(board: Board, picture: NearFar, fit: Fit) -> NDArray[np.bool_]:
    """Pixels that see nothing but the plate's face."""
    s, x, y = board.square_m, fit.board_x, fit.board_y
    x_px = np.hypot(*np.gradient(x)) * INSIDE_PX
    y_px = np.hypot(*np.gradient(y)) * INSIDE_PX
    column, row = np.floor(x / s), np.floor(y / s)
    inside = (column >= -1) & (column < board.columns) & (row >= -1) & (row < board.rows)
    inside &= (column + row) % 2 == 0
    inside &= (np.abs(x / s - column - 0.5) * s < s / 2 - x_px) & (
        np.abs(y / s - row - 0.5) * s < s / 2 - y_px
    )
    if board.marked:
        inside &= (np.abs(x + s / 2) > s / 4 + x_px) | (np.abs(y + s / 2) > s / 4 + y_px)
    return inside & picture.known & (np.abs(picture.off_plane) < ON_PLATE_SIGMAS)
