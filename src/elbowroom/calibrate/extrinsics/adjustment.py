"""The joint least squares over all poses of cameras and board.

Unknown are a motion of each camera and of each pose of the board on the right of its pose, and of each camera with
depth a bias and a scale error of its depth, which a prior keeps small. The pose that defines the world does not move.
Where points measured in the world fix it, they come last, when views are settled with any one camera held: what these
scatter by does not depend on where the world is, and a wrong place cannot make good views look bad.

Each view comes down to nine numbers: of its corners the six that depend on poses (by a QR decomposition), and the
three of its plane. What they scatter by is estimated with the poses (`variances.py`), and views that fit badly all the
same are weighted down: so the covariance says what is true, not what the sigmas of corners promise.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from elbowroom.calibrate.boards.seen_board import SeenBoard, corner_rows, plane_rows
from elbowroom.calibrate.extrinsics.anchor import BoardAnchor, CameraAnchor
from elbowroom.calibrate.extrinsics.known_points import KnownPoints
from elbowroom.calibrate.extrinsics.unknowns import Index, State
from elbowroom.calibrate.extrinsics.variances import Variances, ViewRows
from elbowroom.calibrate.least_squares import Look, covariance, equations, solved
from elbowroom.errors import CalibrationError
from elbowroom.geometry import invert_rigid

Array = NDArray[np.float64]
BIAS_SIGMA_M = 0.005
SCALE_SIGMA = 0.005
"""Prior of a camera's depth: constant error [m] and error per metre; what makers promise is of this size."""
ROUNDS, STEPS = 4, 15
"""Of linearisations with variances estimated anew; of Levenberg-Marquardt before."""
RENEWALS = 12
"""Of variances at one linearisation, at most."""


class Rows(NamedTuple):
    """A part of the least squares.

    Fields:
        residuals: in sigmas, shape (m,).
        rows: their derivatives by the unknowns that they hang on, shape (m, k).
        among: where these stand among all unknowns, shape (k,).
    """

    residuals: Array
    rows: Array
    among: NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What the least squares found.

    Args:
        state: poses and depth errors.
        covariance: of all unknowns, shape (n, n).
        index: where they stand in it.
        variances: what views scatter by.
    """

    state: State
    covariance: Array
    index: Index
    variances: Variances

    def of_camera(self, name: str) -> Array:
        """Covariance of a camera's pose in its own frame, shape (6, 6); zero for the one that is held."""
        if name not in self.index.cameras:
            return np.zeros((6, 6))
        at = self.index.cameras[name]
        return self.covariance[at, at]


def adjust(seen: Sequence[SeenBoard], state: State, held: BoardAnchor | CameraAnchor) -> Solution:
    """Solves for all poses at once, and for what views scatter by.

    Args:
        seen: all views.
        state: where to begin.
        held: what does not move.
    """
    index = Index(state, held)
    variances = Variances.before(list(state.cameras), len(seen), _within(seen))
    state = _solved(seen, state, index, variances)
    for number in range(ROUNDS):
        views = [_rows(one, state, index) for one in seen]
        prior = _prior(state, index)
        for renewal in range(RENEWALS):
            normal, gradient = equations(_look(views, variances, prior, index))
            all_poses = covariance(normal)
            step = -all_poses @ gradient
            off = [view.y + view.rows @ step[view.among] for view in views]
            # only when variances are near their values is it known which views fit badly
            renewed = variances.renewed(views, off, all_poses, robust=number > 0 or renewal > 3)
            change, variances = renewed.change(variances), renewed
            if change < 0.02 and renewal > 4:
                break
        state = _solved(seen, state, index, variances)
        if number and float(np.abs(step).max()) < 1e-6:
            break
    return _solution(seen, state, index, variances)


def fixed_by_points(seen: Sequence[SeenBoard], solution: Solution, known: KnownPoints) -> Solution:
    """Solves once more, with nothing held and points of known place in it.

    Args:
        seen: all views.
        solution: by views alone, in the world's frame as nearly as may be.
        known: the points.

    Raises:
        CalibrationError: a point lies behind a camera that sees it.
    """
    behind = known.behind(solution.state)
    if behind is not None:
        raise CalibrationError(
            f"point {behind[0]}: lies behind camera {behind[1]}, which is said to see it; check its world_m and seen_px"
        )
    index = Index(solution.state, None)
    state = _solved(seen, solution.state, index, solution.variances, known)
    return _solution(seen, state, index, solution.variances, known)


def _solution(
    seen: Sequence[SeenBoard],
    state: State,
    index: Index,
    variances: Variances,
    known: KnownPoints | None = None,
) -> Solution:
    views = [_rows(one, state, index) for one in seen]
    normal, _ = equations(_look(views, variances, _prior(state, index, known), index))
    return Solution(state, covariance(normal), index, variances)


def _within(seen: Sequence[SeenBoard]) -> float:
    """Variance of corners about the best pose of each view alone, over what their sigmas promise; the median view's."""
    ratios = []
    for one in seen:
        residual = corner_rows(one.camera, one.lone[0].camera_from_board, one.corners, one.view)[0]
        ratios.append(float(np.repeat(one.weight, 2) @ residual**2) / max(len(residual) - 6, 1))
    return float(np.median(ratios))


def _solved(
    seen: Sequence[SeenBoard],
    start: State,
    index: Index,
    variances: Variances,
    known: KnownPoints | None = None,
) -> State:
    """Least squares with the variances as they are."""

    def look(state: State) -> Look | None:
        if state is not start and not _all_in_front(seen, state, known):
            return None
        views = [_rows(one, state, index) for one in seen]
        return _look(views, variances, _prior(state, index, known), index)

    return solved(look, lambda state, step: state.moved(step, index), start, steps=STEPS).state


def _all_in_front(seen: Sequence[SeenBoard], state: State, known: KnownPoints | None) -> bool:
    return (known is None or known.behind(state) is None) and all(
        (one.corners @ pose[2, :3] + pose[2, 3]).min() > 0.01
        for one in seen
        for pose in [camera_from_board(one, state)]
    )


def camera_from_board(one: SeenBoard, state: State) -> Array:
    """Where the board stands before the camera of a view, shape (4, 4)."""
    return np.asarray(invert_rigid(state.cameras[one.view.camera]) @ state.boards[one.view.pose])


def _rows(one: SeenBoard, state: State, index: Index) -> ViewRows:
    """A view's nine numbers, or six without depth, and their derivatives."""
    pose = camera_from_board(one, state)
    residual, by_camera, by_board = corner_rows(one.camera, pose, one.corners, one.view)
    root = np.repeat(np.sqrt(one.weight), 2)
    across, of_board = np.linalg.qr(by_board * root[:, None])
    size = 6 if one.plane is None else 9
    rows, y, by_depth = np.zeros((size, 14)), np.zeros(size), np.zeros(size)
    y[:6] = across.T @ (residual * root)
    rows[:6, :6], rows[:6, 6:12] = across.T @ (by_camera * root[:, None]), of_board
    if one.plane is not None:
        of_plane, by_camera, by_board, by_errors = plane_rows(one.plane, pose)
        # predicted less measured, of which the depth's errors are taken out
        y[6:] = of_plane + by_errors @ state.depth_errors[one.view.camera]
        rows[6:, :6], rows[6:, 6:12], rows[6:, 12:] = by_camera, by_board, by_errors
        by_depth[6:] = by_errors[:, 0]
    own, among = _places(one, index)
    return ViewRows(one.view.camera, among, rows[:, own], y, rows[:, 6:12], by_depth)


def _places(one: SeenBoard, index: Index) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Columns of a view's 14 that move, and where they stand among the unknowns."""
    own: list[int] = []
    among: list[int] = []
    for first, place in (
        (0, index.cameras.get(one.view.camera)),
        (6, index.boards.get(one.view.pose)),
        (12, index.depths.get(one.view.camera)),
    ):
        if place is not None:
            own += range(first, first + place.stop - place.start)
            among += range(place.start, place.stop)
    return np.array(own, dtype=np.int64), np.array(among, dtype=np.int64)


def _look(views: Sequence[ViewRows], variances: Variances, prior: Sequence[Rows], index: Index) -> Look:
    """All views, over what they scatter by, and the prior."""
    parts = [*prior]
    for view, weight in zip(views, variances.view, strict=True):
        root = np.linalg.cholesky(variances.inverse(view, float(weight))).T
        parts.append(Rows(root @ view.y, root @ view.rows, view.among))
    residuals, rows, columns = (
        np.concatenate(all_of)
        for all_of in zip(
            *((own.residuals, own.rows.ravel(), np.tile(own.among, len(own.rows))) for own in parts),
            strict=True,
        )
    )
    ends = np.cumsum([0, *np.repeat([own.rows.shape[1] for own in parts], [len(own.rows) for own in parts])])
    sparse = csr_array((rows, columns, ends), shape=(len(residuals), index.size))
    return Look(residuals, lambda: sparse)


def _prior(state: State, index: Index, known: KnownPoints | None = None) -> list[Rows]:
    """Depth errors, which are small, and points of known place."""
    sigma = np.array([BIAS_SIGMA_M, SCALE_SIGMA])
    errors = [
        Rows(error / sigma, np.diag(1 / sigma), np.arange(index.depths[name].start, index.depths[name].stop))
        for name, error in state.depth_errors.items()
    ]
    points = known.rows(state, index) if known is not None else []
    return [*errors, *(Rows(point.residual, point.rows, point.among) for point in points)]
