"""The joint least squares over all poses of cameras and board, with robust weights and honest variances.

Unknown are a motion of each camera and of each pose of the board on the right of its pose, and of each camera with depth a
bias and a scale error of its depth, which a prior keeps small. What the anchor fixes does not move. Residuals are those
of corners [px / sigma] and of planes (`SeenPlane`), each divided by a variance factor of its camera.

The factors are estimated (Förstner 1979) at the level of views, not of corners: what all corners of one image have in
common, such as a hand that shook or a lens that is a little off, shows only there, and a factor from single corners
would make the covariance too small.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.extrinsics.anchor import Anchor, BoardAnchor, CameraAnchor, PointsAnchor
from elbowroom.calibrate.extrinsics.seen_board import SeenBoard, corner_rows, plane_rows
from elbowroom.calibrate.lens import project
from elbowroom.calibrate.rigid import cross_matrix, exp
from elbowroom.geometry import DepthCamera, invert_rigid

Array = NDArray[np.float64]
BIAS_SIGMA_M = 0.005
SCALE_SIGMA = 0.005
"""Prior of a camera's depth: constant error [m] and error per metre; what makers promise is of this size."""
ROUNDS, STEPS = 8, 12
"""Of weights and factors; of Levenberg-Marquardt within each."""
LEAST_FACTOR = 0.05
SHRINKAGE = 40.0
"""Degrees of freedom that the factor of all cameras weighs against a camera's own."""
DOUBTED_FACTOR = 1.5
DOUBT_FREEDOM = 6.0
"""Before views were compared, their common errors are held to be half as large again, and that weighs this much."""
OUTLYING = 4.0
"""A view is weighted down if its chi-square per degree of freedom is more than so many times the factor."""


@dataclass(eq=False)
class State:
    """Where everything is thought to be.

    Args:
        cameras: world_from_camera by name.
        boards: world_from_board by pose.
        depth_errors: bias [m] and scale by name of the camera, shape (2,); only of those with depth.
    """

    cameras: dict[str, Array]
    boards: dict[int, Array]
    depth_errors: dict[str, Array]

    def moved(self, step: Array, index: "Index") -> "State":
        """The state after a step, shape (n,)."""
        return State(
            {
                name: pose @ exp(step[index.cameras[name]]) if name in index.cameras else pose
                for name, pose in self.cameras.items()
            },
            {
                pose: at @ exp(step[index.boards[pose]]) if pose in index.boards else at
                for pose, at in self.boards.items()
            },
            {name: error + step[index.depths[name]] for name, error in self.depth_errors.items()},
        )


class Index:
    """Where in a step each unknown stands; what the anchor holds has no place.

    Args:
        state: all of them.
        anchor: what is held.
    """

    def __init__(self, state: State, anchor: Anchor) -> None:
        at = 0
        self.cameras: dict[str, slice] = {}
        self.boards: dict[int, slice] = {}
        self.depths: dict[str, slice] = {}
        for name in state.cameras:
            if not (isinstance(anchor, CameraAnchor) and anchor.camera == name):
                self.cameras[name], at = slice(at, at + 6), at + 6
        for pose in state.boards:
            if not (isinstance(anchor, BoardAnchor) and anchor.pose == pose):
                self.boards[pose], at = slice(at, at + 6), at + 6
        for name in state.depth_errors:
            self.depths[name], at = slice(at, at + 2), at + 2
        self.size = at


@dataclass(eq=False)
class Weights:
    """What residuals are weighted by.

    Args:
        corner, plane: variance factors by camera.
        view: of each view, 0 to 1, shape (n,).
    """

    corner: dict[str, float]
    plane: dict[str, float]
    view: Array = field(repr=False)


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What the least squares found.

    Args:
        state: poses and depth errors.
        covariance: of all unknowns, shape (n, n).
        index: where they stand in it.
        weights: that were used in the end.
        freedom: degrees of freedom of the views taken together.
        rounds: that it took.
    """

    state: State
    covariance: Array
    index: Index
    weights: Weights
    freedom: float
    rounds: int

    def of_camera(self, name: str) -> Array:
        """Covariance of a camera's pose in its own frame, shape (6, 6); zero for the one that is held."""
        if name not in self.index.cameras:
            return np.zeros((6, 6))
        at = self.index.cameras[name]
        return self.covariance[at, at]


@dataclass(eq=False)
class _View:
    """A view's normal equations, corners and plane apart, over (camera, board, bias, scale) of 14 columns."""

    corner_rows: Array
    corner_residual: Array
    plane_rows: Array
    plane_residual: Array


def adjust(
    cameras: Mapping[str, DepthCamera], seen: Sequence[SeenBoard], state: State, anchor: Anchor
) -> Solution:
    """Solves for all poses at once.

    Args:
        cameras: by name.
        seen: all views.
        state: where to begin, in the world's frame.
        anchor: what fixes the world.
    """
    index = Index(state, anchor)
    names = list(state.cameras)
    weights = Weights(dict.fromkeys(names, 1.0), dict.fromkeys(names, 1.0), np.ones(len(seen)))
    within = _within(seen)
    covariance, freedom, number = np.zeros((index.size, index.size)), 0.0, 0
    for number in range(1, ROUNDS + 1):
        state = _solved(cameras, seen, state, anchor, index, weights)
        views = [_view(one, state) for one in seen]
        normal, _, _ = _normal(cameras, seen, views, state, anchor, index, weights)
        covariance = _inverse(normal)
        renewed, freedom = _renewed(seen, views, covariance, index, weights, within, first=number == 1)
        change = max(
            abs(np.log(new[name] / old[name]))
            for new, old in ((renewed.corner, weights.corner), (renewed.plane, weights.plane))
            for name in names
        )
        weights = renewed
        if change < 0.02 and number > 2:
            break
    state = _solved(cameras, seen, state, anchor, index, weights)
    views = [_view(one, state) for one in seen]
    normal, _, _ = _normal(cameras, seen, views, state, anchor, index, weights)
    return Solution(state, _inverse(normal), index, weights, freedom, number)


def _solved(
    cameras: Mapping[str, DepthCamera],
    seen: Sequence[SeenBoard],
    state: State,
    anchor: Anchor,
    index: Index,
    weights: Weights,
) -> State:
    """Levenberg-Marquardt with the weights as they are."""
    damping = 1e-6
    normal, slope, cost = _equations(cameras, seen, state, anchor, index, weights)
    for _ in range(STEPS):
        step = -np.linalg.solve(normal + damping * np.diag(np.diag(normal)), slope)
        tried = state.moved(step, index)
        if not _all_in_front(seen, tried):
            damping = max(damping * 100, 1e-3)
            continue
        new_normal, new_slope, new_cost = _equations(cameras, seen, tried, anchor, index, weights)
        if not new_cost <= cost * (1 + 1e-12) + 1e-18:
            damping = max(damping * 100, 1e-3)
            if damping > 1e6:
                break
            continue
        done = cost - new_cost < 1e-7 * cost + 1e-15
        state, normal, slope, cost = tried, new_normal, new_slope, new_cost
        damping = max(damping / 100, 1e-9)
        if done:
            break
    return state


def _all_in_front(seen: Sequence[SeenBoard], state: State) -> bool:
    return all(
        (one.corners @ pose[2, :3] + pose[2, 3]).min() > 0.01
        for one in seen
        for pose in [camera_from_board(one, state)]
    )


def camera_from_board(one: SeenBoard, state: State) -> Array:
    """Where the board stands before the camera of a view, shape (4, 4)."""
    return np.asarray(invert_rigid(state.cameras[one.view.camera]) @ state.boards[one.view.pose])


def _view(one: SeenBoard, state: State) -> _View:
    pose = camera_from_board(one, state)
    residual, by_camera, by_board = corner_rows(one.camera, pose, one.corners, one.view)
    root = np.repeat(np.sqrt(one.weight), 2)
    rows = np.zeros((len(residual), 14))
    rows[:, :6], rows[:, 6:12] = by_camera, by_board
    if one.plane is None:
        return _View(rows * root[:, None], residual * root, np.zeros((0, 14)), np.zeros(0))
    of_plane, by_camera, by_board, by_errors = plane_rows(one.plane, pose)
    more = np.concatenate([by_camera, by_board, by_errors], axis=1)
    errors = state.depth_errors[one.view.camera]
    return _View(rows * root[:, None], residual * root, more, of_plane + by_errors @ errors)


def _equations(
    cameras: Mapping[str, DepthCamera],
    seen: Sequence[SeenBoard],
    state: State,
    anchor: Anchor,
    index: Index,
    weights: Weights,
) -> tuple[Array, Array, float]:
    return _normal(cameras, seen, [_view(one, state) for one in seen], state, anchor, index, weights)


def _places(one: SeenBoard, index: Index) -> tuple[Array, Array]:
    """Columns of a view's 14 that move, and where they stand among the unknowns."""
    own, among = [], []
    for first, place in (
        (0, index.cameras.get(one.view.camera)),
        (6, index.boards.get(one.view.pose)),
        (12, index.depths.get(one.view.camera)),
    ):
        if place is not None:
            own += range(first, first + place.stop - place.start)
            among += range(place.start, place.stop)
    return np.array(own), np.array(among)


def _normal(
    cameras: Mapping[str, DepthCamera],
    seen: Sequence[SeenBoard],
    views: Sequence[_View],
    state: State,
    anchor: Anchor,
    index: Index,
    weights: Weights,
) -> tuple[Array, Array, float]:
    """Normal matrix, gradient and half the cost's double, of all residuals, priors and named points."""
    normal, slope, cost = np.zeros((index.size, index.size)), np.zeros(index.size), 0.0
    for number, (one, view) in enumerate(zip(seen, views, strict=True)):
        own, among = _places(one, index)
        name, weight = one.view.camera, weights.view[number]
        for rows, residual, factor in (
            (view.corner_rows, view.corner_residual, weights.corner[name]),
            (view.plane_rows, view.plane_residual, weights.plane[name]),
        ):
            if len(residual):
                used = rows[:, own]
                normal[np.ix_(among, among)] += weight / factor * (used.T @ used)
                slope[among] += weight / factor * (used.T @ residual)
                cost += weight / factor * float(residual @ residual)
    for name, error in state.depth_errors.items():
        at, inverse = index.depths[name], np.array([BIAS_SIGMA_M, SCALE_SIGMA]) ** -2.0
        normal[at, at] += np.diag(inverse)
        slope[at] += inverse * error
        cost += float(inverse @ error**2)
    if isinstance(anchor, PointsAnchor):
        cost += _add_points(cameras, state, anchor, index, normal, slope)
    return normal, slope, cost


def _add_points(
    cameras: Mapping[str, DepthCamera],
    state: State,
    anchor: PointsAnchor,
    index: Index,
    normal: Array,
    slope: Array,
) -> float:
    cost = 0.0
    for sighting in anchor.sightings:
        pose = invert_rigid(state.cameras[sighting.camera])
        in_camera = pose[:3, :3] @ sighting.world_m + pose[:3, 3]
        if in_camera[2] <= 0:
            return float("inf")
        at, by_point = project(cameras[sighting.camera].intrinsics, in_camera[None])
        residual = (at[0] - sighting.pixel) / anchor.sigma_px
        rows = by_point[0] @ np.concatenate([cross_matrix(in_camera), -np.eye(3)], axis=1) / anchor.sigma_px
        place = index.cameras[sighting.camera]
        normal[place, place] += rows.T @ rows
        slope[place] += rows.T @ residual
        cost += float(residual @ residual)
    return cost


def _inverse(normal: Array) -> Array:
    """The inverse of a normal matrix, scaled before, so that metres and radians go together."""
    scale = 1 / np.sqrt(np.diag(normal))
    inverse = np.linalg.inv(normal * np.outer(scale, scale))
    return np.asarray((inverse + inverse.T) / 2 * np.outer(scale, scale))


def _within(seen: Sequence[SeenBoard]) -> float:
    """Variance factor of corners about the best pose of each view alone."""
    squares, freedom = 0.0, 0
    for one in seen:
        residual = corner_rows(one.camera, one.lone[0].camera_from_board, one.corners, one.view)[0]
        squares += float(np.repeat(one.weight, 2) @ residual**2)
        freedom += len(residual) - 6
    return squares / max(freedom, 1)


def _renewed(
    seen: Sequence[SeenBoard],
    views: Sequence[_View],
    covariance: Array,
    index: Index,
    weights: Weights,
    within: float,
    *,
    first: bool,
) -> tuple[Weights, float]:
    """Factors and weights of views from what views are off by, and the degrees of freedom in all.

    The first factors are medians, which views that are far off do not raise; only then are such views weighted down.
    """
    corner: dict[str, list[tuple[float, float]]] = defaultdict(list)
    plane: dict[str, list[tuple[float, float]]] = defaultdict(list)
    off = np.zeros(len(seen))
    for number, (one, view) in enumerate(zip(seen, views, strict=True)):
        own, among = _places(one, index)
        name, weight = one.view.camera, weights.view[number]
        of_block = covariance[np.ix_(among, among)]
        relative = view.corner_rows[:, 6:12]
        slope, information = relative.T @ view.corner_residual, relative.T @ relative
        square = float(slope @ np.linalg.solve(information, slope))
        used = view.corner_rows[:, own]
        # the share of the view's six numbers that the solution follows
        freedom = 6 - weight / weights.corner[name] * float(np.sum((used.T @ used) * of_block))
        corner[name].append((weight * square, max(freedom, 0.0)))
        ratio = square / weights.corner[name] / 6
        if len(view.plane_residual):
            used = view.plane_rows[:, own]
            square = float(view.plane_residual @ view.plane_residual)
            freedom = 3 - weight / weights.plane[name] * float(np.sum((used.T @ used) * of_block))
            plane[name].append((weight * square, max(freedom, 0.0)))
            ratio = max(ratio, square / weights.plane[name] / 3)
        off[number] = ratio
    start = DOUBTED_FACTOR * max(within, LEAST_FACTOR)
    if first:
        renewed = Weights(
            _medians(weights.corner, corner, start),
            _medians(weights.plane, plane, DOUBTED_FACTOR),
            weights.view,
        )
    else:
        renewed = Weights(
            _factors(weights.corner, corner, start),
            _factors(weights.plane, plane, DOUBTED_FACTOR),
            np.minimum(1.0, OUTLYING / np.maximum(off, 1e-9)),
        )
    return renewed, sum(freedom for parts in (*corner.values(), *plane.values()) for _, freedom in parts)


def _factors(
    before: Mapping[str, float], parts: Mapping[str, Sequence[tuple[float, float]]], start: float
) -> dict[str, float]:
    """A factor for each camera: its own, drawn towards that of all, which is drawn towards the start."""
    every = [part for of_camera in parts.values() for part in of_camera]
    squares, freedom = sum(s for s, _ in every), sum(f for _, f in every)
    shared = (DOUBT_FREEDOM * start + squares) / (DOUBT_FREEDOM + freedom)
    factors = {}
    for name in before:
        own = parts.get(name, ())
        value = (SHRINKAGE * shared + sum(s for s, _ in own)) / (SHRINKAGE + sum(f for _, f in own))
        factors[name] = max(value, LEAST_FACTOR)
    return factors


def _medians(
    before: Mapping[str, float], parts: Mapping[str, Sequence[tuple[float, float]]], start: float
) -> dict[str, float]:
    """One factor for all cameras: the median of the views' own."""
    own = [square / freedom for of_camera in parts.values() for square, freedom in of_camera if freedom > 0.5]
    factor = max(float(np.median(own)) if len(own) > 2 else start, LEAST_FACTOR)
    return dict.fromkeys(before, factor)
