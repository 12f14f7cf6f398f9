"""Intrinsics of one camera: OpenCV's first solution, then least squares over corners and depths together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.intrinsics.coverage import advice, cells_seen, tilt_deg
from elbowroom.calibrate.intrinsics.lens_model import PINHOLE, LensModel
from elbowroom.calibrate.least_squares import covariance, huber, solved
from elbowroom.errors import CalibrationError
from elbowroom.extras import package
from elbowroom.geometry import DepthCamera

Array = NDArray[np.float64]
LEAST_VIEWS = 3
LEAST_TILT_DEG = 4.0
MOST_SCALE_OFF = 0.08
"""Depth that differs by more from what the board's size says is a wrong size, not a sensor's error."""
HUBER = 3.0
ENOUGH = 1e-10
"""A step that gains less than this share of the sum of squares is the last one."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundIntrinsics:
    """What was found of one camera.

    Args:
        camera: with the new intrinsics; pose as it was.
        before: as the site had it.
        sigma: standard deviations of fx, fy, cx, cy [px], then of each distortion coefficient.
        depth_scale, depth_bias_m: measured depth = scale * true depth + bias.
        depth_sigma: standard deviations of these two; NaN: the views have no depths.
        residuals_px: of the corners, shape (n, 2) [px].
        residuals_m: of depths, measured less predicted, shape (m,) [m].
        views: the views that were used.
        camera_from_boards: the board's poses in them, shape (views, 4, 4).
        notes: what is weak, and what to capture next.
    """

    camera: DepthCamera
    before: DepthCamera
    sigma: Array
    depth_scale: float
    depth_bias_m: float
    depth_sigma: tuple[float, float]
    residuals_px: Array
    residuals_m: Array
    views: tuple[BoardView, ...]
    camera_from_boards: Array
    notes: tuple[str, ...]

    def row(self) -> dict[str, Any]:
        """A row of kind "intrinsics"."""
        k, before = self.camera.intrinsics, self.before.intrinsics
        return {
            "kind": "intrinsics",
            "camera": self.camera.name,
            **{name: getattr(k, name) for name in ("fx", "fy", "cx", "cy")},
            "distortion": list(k.distortion),
            "sigma": self.sigma,
            "fx_before": before.fx,
            "fy_before": before.fy,
            "depth_scale": self.depth_scale,
            "depth_bias_m": self.depth_bias_m,
            "depth_sigma": list(self.depth_sigma),
            "residual_px": float(np.sqrt(np.mean(self.residuals_px**2))),
            "residual_m": float(np.sqrt(np.mean(self.residuals_m**2))) if len(self.residuals_m) else None,
            "views": len(self.views),
            "corners_by_ninth": cells_seen(self.camera, self.views),
            "notes": list(self.notes),
        }


def solve_intrinsics(
    camera: DepthCamera,
    board: Board,
    views: Sequence[BoardView],
    coefficients: int = 5,
    least_views: int = LEAST_VIEWS,
) -> FoundIntrinsics:
    """Focal lengths, principal point, distortion, depth scale and bias of a camera.

    Args:
        camera: as the site has it: its focal length is where the search starts.
        board: the board.
        views: this camera's.
        coefficients: 0, 5 or 8 of distortion. None at all only where the driver delivers pinhole images: a lens that
            is taken for straight bends the focal length.
        least_views: fewer are refused.

    Raises:
        CalibrationError: too few views, all of them parallel, a board of another size, or no solution; says what to do.
    """
    mine = tuple(view for view in views if view.camera == camera.name)
    if len(mine) < least_views:
        raise CalibrationError(
            f"camera {camera.name}: the board is seen {len(mine)} times, needed are {least_views}; "
            "hold it before this camera, whole and tilted this way and that"
        )
    start = _first_solution(camera, board, mine)
    model = LensModel(camera, board, mine, coefficients)
    return _result(camera, model, *_solved(model, start))


def _first_solution(camera: DepthCamera, board: Board, views: Sequence[BoardView]) -> tuple[Array, Array]:
    """Pinhole numbers by OpenCV, shape (4,), and poses as rotation vector and translation, shape (views, 6)."""
    cv2 = package("cv2")
    k = camera.intrinsics
    matrix = np.array([[k.fx, 0, k.cx], [0, k.fy, k.cy], [0, 0, 1.0]])
    points = [board.corners_in_board[view.corner_ids].astype(np.float32) for view in views]
    seen = [view.corners_px.astype(np.float32).reshape(-1, 1, 2) for view in views]
    poses = []
    for corners, pixels in zip(points, seen, strict=True):
        found, turn, _shift = cv2.solvePnP(corners, pixels, matrix, np.array(k.distortion or (0.0,) * 5))
        if not found:
            raise CalibrationError(
                f"camera {camera.name}: no pose of the board fits its corners; capture again"
            )
        poses.append(np.eye(4))
        poses[-1][:3, :3] = cv2.Rodrigues(turn)[0]
    tilt = tilt_deg(poses)
    if tilt < LEAST_TILT_DEG:
        raise CalibrationError(
            f"camera {camera.name}: all {len(views)} poses of the board are parallel to within {tilt:.1f} degrees, "
            "which leaves the focal length open; tilt the board by 20 to 40 degrees, each time another way"
        )
    flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_ZERO_TANGENT_DIST | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3
    try:
        _, matrix, _, turns, shifts = cv2.calibrateCamera(
            points, seen, (camera.width, camera.height), matrix, np.zeros(5), flags=flags
        )
    except cv2.error as error:
        raise CalibrationError(
            f"camera {camera.name}: OpenCV finds no first solution ({' '.join(str(error).split())[:120]}); "
            "capture again"
        ) from None
    numbers = np.array([matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]])
    return numbers, np.hstack([np.reshape(turns, (-1, 3)), np.reshape(shifts, (-1, 3))])


def _solved(model: LensModel, start: tuple[Array, Array]) -> tuple[Array, Array]:
    """The numbers that fit best, and their covariance."""
    pinhole, poses = start
    numbers = np.concatenate([pinhole, np.zeros(model.coefficients), (1.0, 0.0), poses.ravel()])
    _check_size(model, numbers)
    best = solved(model.look, np.add, numbers, lambda off: huber(np.abs(off), HUBER), enough=ENOUGH)
    spread = max(1.0, best.cost / max(model.seen_rows - len(numbers), 1))
    return best.state, spread * covariance(best.normal)


def _check_size(model: LensModel, numbers: Array) -> None:
    """Depth that the board's size says against depth that was measured."""
    k = model.intrinsics(numbers)
    ratios = [
        float(
            np.median(
                depths.depth_m / model.face_depth(k, model.camera_from_board(numbers, n), depths.pixels)
            )
        )
        for n, depths in enumerate(model.depths)
        if len(depths.depth_m)
    ]
    ratio = float(np.median(ratios)) if ratios else 1.0
    if abs(ratio - 1) > MOST_SCALE_OFF:
        size = model.board.square_m
        raise CalibrationError(
            f"camera {model.camera.name}: depth measured is {ratio:.2f} times what squares of {size:g} m say; "
            f"measure a square (about {ratio * size:.3f} m?), or correct depth_scale_m"
        )


def _result(camera: DepthCamera, model: LensModel, numbers: Array, of_numbers: Array) -> FoundIntrinsics:
    """What the numbers and their covariance say."""
    k = model.intrinsics(numbers)
    sigma = np.sqrt(np.diag(of_numbers))
    poses = np.array([model.camera_from_board(numbers, n) for n in range(len(model.views))])
    scale, bias = (float(n) for n in numbers[model.shared - 2 : model.shared])
    residuals = model.residuals(numbers)[: model.seen_rows]
    sigmas_px = np.concatenate([np.repeat(view.corner_sigma_px, 2) for view in model.views])
    sigmas_m = np.concatenate([depths.sigma_m for depths in model.depths])
    has_depth = bool(len(sigmas_m))
    return FoundIntrinsics(
        camera=replace(camera, intrinsics=k),
        before=camera,
        sigma=sigma[: PINHOLE + model.coefficients],
        depth_scale=scale if has_depth else 1.0,
        depth_bias_m=bias if has_depth else 0.0,
        depth_sigma=(float(sigma[model.shared - 2]), float(sigma[model.shared - 1]))
        if has_depth
        else (float("nan"), float("nan")),
        residuals_px=(residuals[model.is_corner] * sigmas_px).reshape(-1, 2),
        residuals_m=residuals[~model.is_corner] * sigmas_m,
        views=model.views,
        camera_from_boards=poses,
        notes=advice(camera, model.views, list(poses)),
    )
