"""The numbers that are sought of one camera and of the board's poses before it, and what they predict."""

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from elbowroom.calibrate.boards.board import Board
from elbowroom.calibrate.boards.board_view import BoardView
from elbowroom.calibrate.least_squares import Look
from elbowroom.errors import CameraError
from elbowroom.geometry import DepthCamera, Intrinsics
from elbowroom.geometry.lens import directions, project

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
        self.rows = [slice(a, b) for a, b in itertools.pairwise(ends)]
        self.is_corner = np.concatenate(
            [np.r_[np.ones(c, bool), np.zeros(d, bool)] for c, d in zip(corner_rows, depth_rows, strict=True)]
        )
        self.seen_rows = int(ends[-1])
        every = np.arange(len(self.views))
        self._corner_view = np.repeat(every, [len(view.corner_ids) for view in self.views])
        self._corners = np.concatenate(self.corners)
        self._corners_px = np.concatenate([view.corners_px for view in self.views])
        self._corner_sigma = np.concatenate([view.corner_sigma_px for view in self.views])
        self._depth_view = np.repeat(every, depth_rows)
        self._depth_px = np.concatenate([depths.pixels for depths in self.depths])
        self._depth_m = np.concatenate([depths.depth_m for depths in self.depths])
        self._depth_sigma = np.concatenate([depths.sigma_m for depths in self.depths])

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

    def look(self, numbers: Array) -> Look | None:
        """Residuals and rows for the least squares; None: the lens folds back where there are depths."""
        try:
            return Look(self.residuals(numbers), lambda: self.jacobian(numbers))
        except CameraError:
            return None

    def residuals(self, numbers: Array, rays: Array | None = None) -> Array:
        """Corners and depths less what is predicted, over their sigmas, then the priors.

        Args:
            numbers: that are sought.
            rays: of `rays_of` for the same lens, where they are known.
        """
        k = self.intrinsics(numbers)
        scale, bias = numbers[self.shared - 2 : self.shared]
        poses = numbers[self.shared :].reshape(-1, POSE)
        turns, shifts = Rotation.from_rotvec(poses[:, :3]).as_matrix(), poses[:, 3:]
        corners = np.einsum("nij,nj->ni", turns[self._corner_view], self._corners)
        pixels, _ = project(k, corners + shifts[self._corner_view])
        result = np.empty(self.seen_rows)
        result[self.is_corner] = ((self._corners_px - pixels) / self._corner_sigma[:, None]).ravel()
        rays = self.rays_of(numbers) if rays is None else rays
        normals = turns[:, :, 2]
        offset = (normals * shifts).sum(axis=1)[self._depth_view]
        z = offset / np.einsum("ni,ni->n", rays, normals[self._depth_view])
        true = z * np.linalg.norm(rays, axis=1) if self.camera.depth_kind == "radial" else z
        result[~self.is_corner] = (self._depth_m - scale * true - bias) / self._depth_sigma
        prior = numbers[PINHOLE : PINHOLE + self.coefficients] / PRIOR_DISTORTION[: self.coefficients]
        return np.concatenate([result, prior, [(scale - 1) / PRIOR_SCALE, bias / PRIOR_BIAS_M]])

    def rays_of(self, numbers: Array) -> Array:
        """Directions of the pixels with depths, z = 1, shape (m, 3)."""
        if not len(self._depth_px):
            return np.zeros((0, 3))
        return np.column_stack(
            [directions(self.intrinsics(numbers), self._depth_px), np.ones(len(self._depth_px))]
        )

    def face_depth(self, k: Intrinsics, camera_from_board: Array, pixels: Array) -> Array:
        """Depth of the board's face along the rays of pixels, in the camera's kind [m].

        Args:
            k: the camera's intrinsics.
            camera_from_board: pose of the board, shape (4, 4).
            pixels: raw, shape (n, 2) [px].
        """
        rays = np.column_stack([directions(k, pixels), np.ones(len(pixels))])
        normal = camera_from_board[:3, 2]
        z = float(normal @ camera_from_board[:3, 3]) / (rays @ normal)
        return np.asarray(z * np.linalg.norm(rays, axis=1) if self.camera.depth_kind == "radial" else z)

    def jacobian(self, numbers: Array) -> Array:
        """Derivative of the residuals by differences: each number of the poses is moved in all views at once."""
        rays = self.rays_of(numbers)
        here = self.residuals(numbers, rays)
        result = np.zeros((len(here), len(numbers)))
        for column in range(self.shared):
            step = STEP * max(1.0, abs(numbers[column]))
            moved = numbers.copy()
            moved[column] += step
            result[:, column] = (self.residuals(moved) - here) / step
        for number in range(POSE):
            moved = numbers.copy()
            moved[self.shared + number :: POSE] += STEP
            change = (self.residuals(moved, rays) - here) / STEP
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
