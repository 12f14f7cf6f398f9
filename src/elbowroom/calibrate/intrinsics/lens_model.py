"""The numbers that are sought of one camera and of the board's poses before it, and what they predict."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.calibrate.board import Board
from elbowroom.calibrate.board_view import BoardView
from elbowroom.calibrate.lens import directions, project
from elbowroom.geometry import DepthCamera, Intrinsics

Array = NDArray[np.float64]
PINHOLE = 4
DEPTH = 2
POSE = 6
MOST_DEPTHS = 250
"""Depths taken of each view."""
PRIOR_DISTORTION = (0.3, 0.3, 0.02, 0.02, 0.15, 0.3, 0.3, 0.15)
"""Sigma of each coefficient before anything is seen: where the board was never held, a polynomial may do anything."""
PRIOR_SCALE, PRIOR_BIAS_M = 0.05, 0.05
STEP = 1e-6


class Depths(NamedTuple):
    """Depths of the board's face in one view.

    Fields:
        pixels: shape (m, 2) [px].
        depth_m: the camera's kind [m], shape (m,).
        sigma_m: shape (m,) [m].
    """

    pixels: Array
    depth_m: Array
    sigma_m: Array


class LensModel:
    """Residuals of corners and depths, in sigmas, over the numbers that are sought.

    The numbers are fx, fy, cx, cy, as many distortion coefficients as asked for, scale and bias of
    depth (measured = scale * true + bias), and of each view rotation vector and translation of camera_from_board.

    Args:
        camera: size, kind of depth, noise.
        board: the board.
        views: of this camera.
        coefficients: 0, 5 or 8.
    """

    def __init__(
        self, camera: DepthCamera, board: Board, views: Sequence[BoardView], coefficients: int
    ) -> None:
        self.camera, self.board, self.views = camera, board, tuple(views)
        self.coefficients = coefficients
        self.shared = PINHOLE + coefficients + DEPTH
        self.depths = [_few_depths(camera, view) for view in views]
        self.corners = [board.corners_in_board[view.corner_ids] for view in views]
        corner_rows = [2 * len(view.corner_ids) for view in views]
        depth_rows = [len(depths.depth_m) for depths in self.depths]
        ends = np.cumsum([0, *(c + d for c, d in zip(corner_rows, depth_rows, strict=True))])
        self.rows = [slice(a, b) for a, b in zip(ends[:-1], ends[1:], strict=True)]
        self.is_corner = np.concatenate(
            [np.r_[np.ones(c, bool), np.zeros(d, bool)] for c, d in zip(corner_rows, depth_rows, strict=True)]
        )
        self.seen_rows = int(ends[-1])

    def intrinsics(self, numbers: Array) -> Intrinsics:
        """The lens that the numbers describe."""
        fx, fy, cx, cy = (float(n) for n in numbers[:PINHOLE])
        return Intrinsics(
            fx, fy, cx, cy, tuple(float(n) for n in numbers[PINHOLE : PINHOLE + self.coefficients])
        )

    def camera_from_board(self, numbers: Array, view: int) -> Array:
        """The board's pose in a view, shape (4, 4)."""
        at = self.shared + POSE * view
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(numbers[at : at + 3]).as_matrix()
        pose[:3, 3] = numbers[at + 3 : at + 6]
        return pose

    def residuals(self, numbers: Array) -> Array:
        """Corners and depths less what is predicted, over their sigmas, then the priors."""
        k = self.intrinsics(numbers)
        scale, bias = numbers[self.shared - 2 : self.shared]
        parts = []
        for n, (view, depths) in enumerate(zip(self.views, self.depths, strict=True)):
            pose = self.camera_from_board(numbers, n)
            pixels, _ = project(k, self.corners[n] @ pose[:3, :3].T + pose[:3, 3])
            parts.append(((view.corners_px - pixels) / view.corner_sigma_px[:, None]).ravel())
            if len(depths.depth_m):
                true = self.face_depth(k, pose, depths.pixels)
                parts.append((depths.depth_m - scale * true - bias) / depths.sigma_m)
        prior = numbers[PINHOLE : PINHOLE + self.coefficients] / PRIOR_DISTORTION[: self.coefficients]
        return np.concatenate([*parts, prior, [(scale - 1) / PRIOR_SCALE, bias / PRIOR_BIAS_M]])

    def face_depth(self, k: Intrinsics, camera_from_board: Array, pixels: Array) -> Array:
        """Depth of the board's face along the rays of pixels, in the camera's kind [m]."""
        rays = np.column_stack([directions(k, pixels), np.ones(len(pixels))])
        normal = camera_from_board[:3, 2]
        z = float(normal @ camera_from_board[:3, 3]) / (rays @ normal)
        return np.asarray(z * np.linalg.norm(rays, axis=1) if self.camera.depth_kind == "radial" else z)

    def jacobian(self, numbers: Array) -> Array:
        """Derivative of the residuals by differences: each number of the poses is moved in all views at once."""
        here = self.residuals(numbers)
        result = np.zeros((len(here), len(numbers)))
        for column in range(self.shared):
            step = STEP * max(1.0, abs(numbers[column]))
            moved = numbers.copy()
            moved[column] += step
            result[:, column] = (self.residuals(moved) - here) / step
        for number in range(POSE):
            moved = numbers.copy()
            moved[self.shared + number :: POSE] += STEP
            change = (self.residuals(moved) - here) / STEP
            for view, rows in enumerate(self.rows):
                result[rows, self.shared + POSE * view + number] = change[rows]
        return result


def _few_depths(camera: DepthCamera, view: BoardView) -> Depths:
    """Some of the view's depths, evenly over the board."""
    count = len(view.plane_depth_m)
    take = np.unique(np.linspace(0, count - 1, min(count, MOST_DEPTHS)).astype(np.int64))
    depth = view.plane_depth_m[take]
    sigma = (
        np.full(len(depth), 0.001) if camera.noise is None else np.maximum(camera.noise.sigma(depth), 0.001)
    )
    # those that are left out would have made these more exact
    return Depths(view.plane_px[take], depth, sigma * np.sqrt(max(len(depth), 1) / max(count, 1)))
