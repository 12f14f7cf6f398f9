"""One view of the board by itself: where it stands before the camera, and how sure that is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.seen_plane import SeenPlane, seen_plane
from elbowroom.calibrate.least_squares import Look, huber, solved
from elbowroom.errors import CalibrationError
from elbowroom.extras import package
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.lens import directions, project
from elbowroom.geometry.twist import cross_matrix, moved

Array = NDArray[np.float64]
LEAST_CORNERS = 6
STEPS = 30
HUBER = 2.5
"""Corners farther off than so many sigmas pull no more than that."""
WORST_PX = 4.0
"""A view whose corners are this many sigmas off at best and by more than `WORST_SHARE` does not show this board."""
WORST_SHARE = 0.15
"""Of a square's width in the image."""
DOUBT = 25.0
"""A second pose of the board whose chi-square is worse by less than this is kept as a possibility."""


@dataclass(frozen=True, slots=True, eq=False)
class Lone:
    """A pose of the board that explains one view.

    Args:
        camera_from_board: shape (4, 4).
        information: of a motion of the board in its own frame, rotation vector then translation, shape (6, 6).
        chi2: sum of squares, in sigmas.
    """

    camera_from_board: Array
    information: Array
    chi2: float


def spread(lone: Lone, reach_m: float) -> float:
    """How far the board's outer corners may be off in a view by itself, one sigma [m].

    Args:
        lone: the pose.
        reach_m: greatest coordinate of a corner [m].
    """
    covariance = np.linalg.inv(lone.information + 1e-9 * np.eye(6))
    return float(np.sqrt(np.trace(covariance[3:, 3:]) + np.trace(covariance[:3, :3]) * reach_m**2))


@dataclass(frozen=True, slots=True, eq=False)
class SeenBoard:
    """A view, made ready for the joint solution.

    Args:
        view: as it was seen.
        camera: who saw it.
        corners: in the board's frame, those that were seen, shape (n, 3) [m].
        weight: of each corner, 0 to 1, shape (n,): what is far off its neighbours counts less.
        plane: what depth says; None: nothing.
        lone: one or two poses, the likelier first.
        depth_over_corners: distance of the board by depth over that by its corners alone, and the sigma of the latter's
            share; None without depth.
    """

    view: BoardView
    camera: DepthCamera
    corners: Array
    weight: Array
    plane: SeenPlane | None
    lone: tuple[Lone, ...]
    depth_over_corners: tuple[float, float] | None


def corner_rows(
    camera: DepthCamera, camera_from_board: Array, corners: Array, view: BoardView
) -> tuple[Array, Array, Array]:
    """Residuals of corners in sigmas, and their derivatives by a motion of the camera and of the board.

    Both motions are on the right of their pose, in their own frame: world_from_camera @ exp(motion).

    Args:
        camera: that sees them.
        camera_from_board: pose of the board, shape (4, 4).
        corners: in the board's frame, shape (n, 3) [m].
        view: where they were seen, and with which sigmas.

    Returns:
        shapes (2 n,), (2 n, 6), (2 n, 6).
    """
    rotation = camera_from_board[:3, :3]
    in_camera = corners @ rotation.T + camera_from_board[:3, 3]
    at, by_point = project(camera.intrinsics, in_camera)
    by_point = by_point / view.corner_sigma_px[:, None, None]
    residual = (at - view.corners_px) / view.corner_sigma_px[:, None]
    by_camera, by_board = np.empty((2, len(corners), 2, 6))
    by_camera[:, :, :3], by_camera[:, :, 3:] = by_point @ cross_matrix(in_camera), -by_point
    by_board[:, :, 3:] = by_point @ rotation
    by_board[:, :, :3] = -by_board[:, :, 3:] @ cross_matrix(corners)
    return residual.ravel(), by_camera.reshape(-1, 6), by_board.reshape(-1, 6)


def plane_rows(plane: SeenPlane, camera_from_board: Array) -> tuple[Array, Array, Array, Array]:
    """Residuals of the plane in sigmas, and their derivatives by motions of camera and board, and by bias and scale.

    Returns:
        shapes (3,), (3, 6), (3, 6), (3, 2).
    """
    rotation, origin = camera_from_board[:3, :3], camera_from_board[:3, 3]
    normal = rotation[:, 2]
    height = float(normal @ origin)
    m = normal / height
    by_normal = (np.eye(3) - np.outer(m, origin)) / height
    by_origin = -np.outer(m, normal) / height
    # the camera's motion moves what it sees the other way; rows are predicted less measured
    by_camera = np.concatenate(
        [by_normal @ cross_matrix(normal) + by_origin @ cross_matrix(origin), -by_origin], axis=1
    )
    by_board = np.concatenate(
        [by_normal @ -rotation @ cross_matrix(np.array([0.0, 0.0, 1.0])), by_origin @ rotation], axis=1
    )
    errors = np.column_stack([plane.by_bias, plane.by_scale])
    return plane.root @ (m - plane.m), plane.root @ by_camera, plane.root @ by_board, plane.root @ errors


def seen_boards(
    cameras: Mapping[str, DepthCamera], board: Board, views: Sequence[BoardView]
) -> list[SeenBoard]:
    """Every view by itself.

    Args:
        cameras: by name.
        board: that was shown.
        views: of any cameras and poses.

    Raises:
        CalibrationError: a view of a camera that is not there, or that does not show this board.
        PackageError: OpenCV is not installed.
    """
    return [seen_board(cameras, board, view) for view in views]


def seen_board(cameras: Mapping[str, DepthCamera], board: Board, view: BoardView) -> SeenBoard:
    """One view by itself; see `seen_boards`.

    Args:
        cameras: by name.
        board: that was shown.
        view: of one camera.
    """
    if view.camera not in cameras:
        raise CalibrationError(
            f"camera {view.camera}: has a view of the board but is not among the site's cameras ({', '.join(cameras)})"
        )
    what = f"camera {view.camera}, pose {view.pose}"
    camera, ids = cameras[view.camera], view.corner_ids
    if len(ids) < LEAST_CORNERS:
        raise CalibrationError(
            f"{what}: {len(ids)} corners of the board, at least {LEAST_CORNERS} are needed; half-seen, leave it out"
        )
    if ids.min() < 0 or ids.max() >= board.columns * board.rows:
        raise CalibrationError(
            f"{what}: corner {ids.max()}, the board has {board.columns} x {board.rows}; another board?"
        )
    if (view.corner_sigma_px <= 0).any():
        raise CalibrationError(f"{what}: corner_sigma_px must be above 0")
    corners = board.corners_in_board[ids]
    if np.linalg.svd(corners - corners.mean(axis=0))[1][1] < 0.5 * board.square_m:
        raise CalibrationError(f"{what}: the corners that are seen lie in one line; half-seen, leave it out")
    plane = seen_plane(camera, view.plane_px, view.plane_depth_m)
    starts = _starts(camera, corners, view, what)
    solved = [_refined(camera, corners, view, None, start) for start in starts]
    alone = min(solved, key=lambda s: s[0].chi2)
    if plane is not None:
        solved = [_refined(camera, corners, view, plane, one.camera_from_board) for one, _ in solved]
    solved.sort(key=lambda s: s[0].chi2)
    best, weight = solved[0]
    _require_this_board(camera, board, corners, view, best, what)
    _require_its_face(corners, best, what)
    kept = [best]
    for other, _ in solved[1:]:
        differs = np.linalg.norm(other.camera_from_board[:3, :3] - best.camera_from_board[:3, :3]) > 0.02
        if differs and other.chi2 < best.chi2 + DOUBT and len(kept) < 2:
            kept.append(other)
    return SeenBoard(
        view, camera, corners, weight, plane, tuple(kept), _depth_over_corners(plane, alone[0], corners)
    )


def _starts(camera: DepthCamera, corners: Array, view: BoardView, what: str) -> list[Array]:
    """The two poses that a plane has by its corners (Collins, Bartoli: Infinitesimal plane-based pose, 2014)."""
    cv2 = package("cv2")
    seen = directions(camera.intrinsics, view.corners_px, f"camera {camera.name}")
    middle = corners.mean(axis=0)
    try:
        _, turns, ways, _ = cv2.solvePnPGeneric(
            np.ascontiguousarray(corners - middle), seen, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
        )
    except cv2.error as error:
        raise CalibrationError(
            f"{what}: its corners lie in one line or in one place; leave the view out"
        ) from error
    starts = []
    for turn, way in zip(turns, ways, strict=True):
        pose = np.eye(4)
        pose[:3, :3] = cv2.Rodrigues(turn)[0]
        pose[:3, 3] = way.ravel() - pose[:3, :3] @ middle
        if np.isfinite(pose).all() and (corners @ pose[2, :3] + pose[2, 3]).min() > 0:
            starts.append(pose)
    if not starts:
        raise CalibrationError(f"{what}: no pose of the board before the camera explains its corners")
    return starts


def _refined(
    camera: DepthCamera, corners: Array, view: BoardView, plane: SeenPlane | None, start: Array
) -> tuple[Lone, Array]:
    """Least squares from a start, with Huber's weights; the pose, and the corners' weights."""

    def look(pose: Array) -> Look | None:
        if (corners @ pose[2, :3] + pose[2, 3]).min() <= 0:
            return None
        residuals, _, rows = corner_rows(camera, pose, corners, view)
        if plane is not None:
            more, more_rows = _lone_plane_rows(plane, pose)
            residuals, rows = np.concatenate([residuals, more]), np.concatenate([rows, more_rows])
        return Look(residuals, lambda: rows)

    def weigh(residuals: Array) -> Array:
        of_corners, weight = slice(0, 2 * len(corners)), np.ones(len(residuals))
        size = np.linalg.norm(residuals[of_corners].reshape(-1, 2), axis=1)
        spread = max(1.0, float(np.median(size)) / 1.1774)
        weight[of_corners] = np.repeat(huber(size, HUBER * spread), 2)
        return weight

    best = solved(look, moved, start, weigh, steps=STEPS, enough=1e-5)
    return Lone(best.state, best.normal, best.cost), best.weight[: 2 * len(corners) : 2]


def _lone_plane_rows(plane: SeenPlane, camera_from_board: Array) -> tuple[Array, Array]:
    """Residuals of the plane and rows by a motion of the board, where bias and scale of the depth are not known yet."""
    residuals, _, rows, _ = plane_rows(plane, camera_from_board)
    # a millimetre and a thousandth at least
    errors = plane.root @ np.column_stack([plane.by_bias * 2e-3, plane.by_scale * 2e-3])
    whiten = np.linalg.inv(np.linalg.cholesky(np.eye(3) + errors @ errors.T))
    return whiten @ residuals, whiten @ rows


def _require_this_board(
    camera: DepthCamera, board: Board, corners: Array, view: BoardView, best: Lone, what: str
) -> None:
    """Corners that no pose of the board explains are those of something else, or numbered as in a mirror."""
    residual = corner_rows(camera, best.camera_from_board, corners, view)[0].reshape(-1, 2)
    in_sigmas = float(np.sqrt(np.median((residual**2).sum(axis=1)) / 2))
    off_px = float(np.median(np.linalg.norm(residual * view.corner_sigma_px[:, None], axis=1)))
    middle = best.camera_from_board[:3, :3] @ corners.mean(axis=0) + best.camera_from_board[:3, 3]
    square_px = board.square_m * camera.intrinsics.fx / middle[2]
    if in_sigmas > WORST_PX and off_px > WORST_SHARE * square_px:
        raise CalibrationError(
            f"{what}: no pose of the board explains its corners ({off_px:.1f} px off, squares are {square_px:.0f} px "
            "wide); a mirrored image, another board, or a lens that is not calibrated: check columns and rows, or "
            "leave it out"
        )


def _require_its_face(corners: Array, best: Lone, what: str) -> None:
    """The board's z axis points away from who sees its face; in a mirrored image it seems to point at the camera."""
    middle = best.camera_from_board[:3, :3] @ corners.mean(axis=0) + best.camera_from_board[:3, 3]
    if best.camera_from_board[:3, 2] @ middle <= 0:
        raise CalibrationError(
            f"{what}: the corners are numbered as in a mirror: the image is mirrored, or it shows the board's back; "
            "mend the camera's driver, or leave the view out"
        )


def _depth_over_corners(plane: SeenPlane | None, alone: Lone, corners: Array) -> tuple[float, float] | None:
    if plane is None:
        return None
    rotation, centre = alone.camera_from_board[:3, :3], corners.mean(axis=0)
    middle = rotation @ centre + alone.camera_from_board[:3, 3]
    # the middle moves by rotation @ (t + w x centre)
    slope = plane.m @ rotation @ np.concatenate([-cross_matrix(centre), np.eye(3)], axis=1)
    ratio = float(1 / (plane.m @ middle))
    variance = slope @ np.linalg.solve(alone.information + 1e-9 * np.eye(6), slope)
    return ratio, ratio * float(np.sqrt(max(variance, 0.0)))
