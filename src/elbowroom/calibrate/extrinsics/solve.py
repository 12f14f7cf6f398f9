"""Extrinsics from views of the board: all steps in a row."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.boards.seen_board import SeenBoard, corner_rows, seen_boards
from elbowroom.calibrate.boards.seen_plane import rays_of
from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.calibrate.extrinsics.adjustment import Solution, adjust, camera_from_board, fixed_by_points
from elbowroom.calibrate.extrinsics.anchor import (
    Anchor,
    CameraAnchor,
    PointsAnchor,
    world_from_base,
)
from elbowroom.calibrate.extrinsics.contradiction import require_points_agree
from elbowroom.calibrate.extrinsics.disagreement import (
    require_board_size,
    require_still,
    require_tilts,
    weak_points,
)
from elbowroom.calibrate.extrinsics.graph import first_solution, require_one_piece, shared_poses
from elbowroom.calibrate.extrinsics.known_points import KnownPoints
from elbowroom.calibrate.extrinsics.misread import misread_views
from elbowroom.calibrate.extrinsics.out_of_step import require_in_step
from elbowroom.calibrate.extrinsics.unknowns import State
from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Extrinsics:
    """What was found.

    Args:
        cameras: in the order in which they were given.
        world_from_board: of each pose, shape (4, 4).
        depth_bias_m, depth_scale: by camera: its depth reads so much too far, and per metre; only those with depth.
        depth_covariance: of bias [m] and scale by camera, shape (2, 2).
        corner_factor, plane_factor: variance factors by camera: how many times the variance of what was seen is that
            which its sigmas promise.
        seen: all views, in which residuals are.
        left_out: views that were not used, and why.
        shared: how many poses each two cameras saw together.
        view_weight: of each view in the end; below one: it fits the others badly.
        points_unseen: names of corners of the board that were measured in a pose that no camera saw; not used.
        points_off_m: how far each point of known place is probably from where it was measured [m], by name.
    """

    cameras: tuple[CalibratedCamera, ...]
    world_from_board: Mapping[int, Array]
    depth_bias_m: Mapping[str, float]
    depth_scale: Mapping[str, float]
    depth_covariance: Mapping[str, Array] = field(repr=False)
    corner_factor: Mapping[str, float]
    plane_factor: Mapping[str, float]
    seen: tuple[SeenBoard, ...]
    left_out: tuple[Trouble, ...]
    shared: Mapping[tuple[str, str], int]
    view_weight: Array
    points_unseen: tuple[str, ...]
    points_off_m: Mapping[str, float]

    def depth_errors(self) -> dict[str, tuple[float, float]]:
        """Bias [m] and scale of those cameras whose depth reads wrong by more than chance at 1 m or at 4 m."""
        wrong = {}
        for name, bias in self.depth_bias_m.items():
            error = np.array([bias, self.depth_scale[name]])
            for depth in (1.0, 4.0):
                at = np.array([1.0, depth])
                if abs(at @ error) > 2 * np.sqrt(at @ self.depth_covariance[name] @ at):
                    wrong[name] = (bias, self.depth_scale[name])
        return wrong

    def row(self) -> dict[str, Any]:
        """How much was found, and how far measured points are from where they are seen."""
        return {
            "cameras": len(self.cameras),
            "poses": len(self.world_from_board),
            "views": len(self.seen),
            "points_unseen": list(self.points_unseen),
            "points_off_m": dict(self.points_off_m),
        }


def solve_extrinsics(
    cameras: Sequence[DepthCamera],
    board: Board,
    views: Sequence[BoardView],
    anchor: Anchor,
    *,
    before: Mapping[str, DepthCamera] | None = None,
    least_views: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> Extrinsics:
    """Finds where the cameras are.

    Args:
        cameras: with their intrinsics; their poses are not used, but for that of a `CameraAnchor`.
        board: what they saw.
        views: of any number of poses; not every camera sees each.
        anchor: what fixes the world.
        before: cameras as the site has them, to say what changed; None: those given.
        least_views: of each camera.
        progress: is told what is being done.

    Raises:
        CalibrationError: views that do not fix the poses or do not go together; the message says what to capture.
        PackageError: OpenCV is not installed.
    """
    named = {camera.name: camera for camera in cameras}
    _require_once(views)
    progress("each view by itself")
    seen = seen_boards(named, board, views)
    _require_views(named, seen, least_views)
    require_board_size(board, seen)
    require_in_step(named, board, seen)
    progress("first solution")
    corners = board.corners_in_board
    base_from_camera, base_from_board = first_solution(list(named), seen, corners)
    misread = misread_views(seen, base_from_camera, base_from_board, corners)
    if misread:
        seen = [one for one in seen if all(one is not other for other, _ in misread)]
        _require_views(named, seen, least_views)
        base_from_camera, base_from_board = first_solution(list(named), seen, corners)
    unseen: tuple[str, ...] = ()
    if isinstance(anchor, PointsAnchor):
        kept = anchor.on_poses(base_from_board)
        unseen = tuple(point.name for point in anchor.points if point not in kept.points)
        anchor = kept
    world = world_from_base(anchor, named, base_from_camera, base_from_board)
    state = State(
        {name: world @ base_from_camera[name] for name in named},
        {pose: world @ at for pose, at in base_from_board.items()},
        {name: np.zeros(2) for name in named if any(one.plane is not None for one in _of(name, seen))},
    )
    progress(f"{len(named)} cameras and {len(state.boards)} poses together")
    known = KnownPoints(anchor, named) if isinstance(anchor, PointsAnchor) else None
    held = CameraAnchor(seen[0].view.camera) if isinstance(anchor, PointsAnchor) else anchor
    solution = adjust(seen, state, held)
    require_still(seen, solution, corners)
    require_tilts(seen, solution)
    if known is not None:
        solution = fixed_by_points(seen, solution, known)
        require_points_agree(known, solution)
    left_out = tuple(
        Trouble(one.view.camera, one.view.pose, Fault.MISREAD, f"by {off_m * 1e3:.0f} mm")
        for one, off_m in misread
    )
    return _found(named, before or named, seen, left_out, unseen, solution, known)


def _of(camera: str, seen: Sequence[SeenBoard]) -> list[SeenBoard]:
    return [one for one in seen if one.view.camera == camera]


def _require_once(views: Sequence[BoardView]) -> None:
    known = set()
    for view in views:
        if (view.camera, view.pose) in known:
            raise CalibrationError(
                f"camera {view.camera}, pose {view.pose}: there are two views; one is allowed"
            )
        known.add((view.camera, view.pose))


def _require_views(cameras: Mapping[str, DepthCamera], seen: Sequence[SeenBoard], least: int) -> None:
    require_one_piece(list(cameras), seen)
    counts = {name: len(_of(name, seen)) for name in cameras}
    few = {name: count for name, count in counts.items() if count < least}
    if few:
        words = ", ".join(f"{name} ({count})" for name, count in list(few.items())[:4])
        raise CalibrationError(
            f"too few poses of the board seen by {words}; at least {least} are asked for "
            "(calibration.least_views): show the board to them again"
        )


def _found(
    cameras: Mapping[str, DepthCamera],
    before: Mapping[str, DepthCamera],
    seen: Sequence[SeenBoard],
    left_out: tuple[Trouble, ...],
    unseen: tuple[str, ...],
    solution: Solution,
    known: KnownPoints | None,
) -> Extrinsics:
    shared = shared_poses(seen)
    found = []
    for name in cameras:
        own = _of(name, seen)
        covariance = solution.of_camera(name)
        common: dict[str, int] = defaultdict(int)
        for (a, b), count in shared.items():
            if name in (a, b):
                common[b if a == name else a] += count
        sure = np.sqrt([np.trace(covariance[3:, 3:]), np.trace(covariance[:3, :3])])
        found.append(
            CalibratedCamera(
                camera=replace(cameras[name], world_from_camera=solution.state.cameras[name]),
                before=before.get(name),
                covariance=covariance,
                residuals_px=np.concatenate([corner_distances(one, solution.state) for one in own]),
                residuals_m=np.concatenate([depth_distances(one, solution.state) for one in own]),
                notes=()
                if name not in solution.index.cameras
                else weak_points(name, own, common, float(sure[0]), float(np.degrees(sure[1]))),
            )
        )
    errors = solution.state.depth_errors
    return Extrinsics(
        cameras=tuple(found),
        world_from_board=solution.state.boards,
        depth_bias_m={name: float(error[0]) for name, error in errors.items()},
        depth_scale={name: float(error[1]) for name, error in errors.items()},
        depth_covariance={name: solution.covariance[at, at] for name, at in solution.index.depths.items()},
        corner_factor=solution.variances.corner,
        plane_factor=solution.variances.plane,
        seen=tuple(seen),
        left_out=left_out,
        shared=shared,
        view_weight=solution.variances.view,
        points_unseen=unseen,
        points_off_m={} if known is None else known.off_m(solution.state, solution.index),
    )


def corner_distances(one: SeenBoard, state: State) -> Array:
    """Distances between corners seen and corners projected, shape (n,) [px]."""
    residual = corner_rows(one.camera, camera_from_board(one, state), one.corners, one.view)[0]
    return np.asarray(np.linalg.norm(residual.reshape(-1, 2) * one.view.corner_sigma_px[:, None], axis=1))


def depth_distances(one: SeenBoard, state: State) -> Array:
    """Depth measured, with the camera's bias and scale error in it, less that of the board, shape (n,) [m]."""
    if not len(one.view.plane_depth_m):
        return np.zeros(0)
    pose = camera_from_board(one, state)
    m = pose[:3, 2] / (pose[:3, 2] @ pose[:3, 3])
    return np.asarray(one.view.plane_depth_m - 1 / (rays_of(one.camera, one.view.plane_px) @ m))
