"""Points of measured place in the least squares: how far they are seen from where they were measured.

A measured place is off by an unknown error of sigma `sigma_m` in each coordinate; pixels by `sigma_px` as well. Seen in
several images, one such error moves the point in all of them, so a point's residuals r have the variance

    V = sigma_px^2 I + sigma_m^2 S S^T

with S their derivative by a shift of the measured place. Corners of the board are compared in the world's frame: there
S = -I, and V = sigma_m^2 I. Everything here is divided by a root of V.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.extrinsics.anchor import BoardCorner, PointsAnchor, SeenPoint
from elbowroom.calibrate.extrinsics.unknowns import Index, State
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.geometry.lens import project
from elbowroom.geometry.twist import cross_matrix

Array = NDArray[np.float64]


class PointRows(NamedTuple):
    """A point at one linearisation.

    Fields:
        residual: over its sigmas, shape (m,).
        rows: its derivatives by the unknowns that it hangs on, shape (m, k).
        among: where these stand among all unknowns, shape (k,).
        by_shift: its derivatives by a shift of the measured place, shape (m, 3) [1/m].
    """

    residual: Array
    rows: Array
    among: NDArray[np.int64]
    by_shift: Array


@dataclass(frozen=True, slots=True, eq=False)
class KnownPoints:
    """Points and the cameras that see them.

    Args:
        anchor: the points.
        cameras: by name.
    """

    anchor: PointsAnchor
    cameras: Mapping[str, DepthCamera]

    def rows(self, state: State, index: Index) -> list[PointRows]:
        """The rows of each point, in their order.

        Args:
            state: in the world's frame; no point is behind a camera that sees it.
            index: nothing is held in it.
        """
        return [
            _corner_rows(point, self.anchor.sigma_m, state, index)
            if isinstance(point, BoardCorner)
            else _pixel_rows(point, self, state, index)
            for point in self.anchor.points
        ]

    def behind(self, state: State) -> tuple[str, str] | None:
        """Name of a point that lies behind a camera that sees it, and the camera's."""
        for point in self.anchor.points:
            for camera in point.seen_px if isinstance(point, SeenPoint) else ():
                if _in_camera(point.world_m, state.cameras[camera])[2] <= 0:
                    return point.name, camera
        return None

    def off_m(self, state: State, index: Index) -> dict[str, float]:
        """How far each point is probably from where it was measured [m], by name."""
        sigma_m, rows = self.anchor.sigma_m, self.rows(state, index)
        return {
            point.name: sigma_m**2 * float(np.linalg.norm(own.by_shift.T @ own.residual))
            for point, own in zip(self.anchor.points, rows, strict=True)
        }


def _corner_rows(point: BoardCorner, sigma_m: float, state: State, index: Index) -> PointRows:
    pose, at = state.boards[point.pose], index.boards[point.pose]
    off = pose[:3, :3] @ point.board_m + pose[:3, 3] - point.world_m
    by_motion = pose[:3, :3] @ np.concatenate([-cross_matrix(point.board_m), np.eye(3)], axis=1)
    among = np.arange(at.start, at.stop)
    return PointRows(off / sigma_m, by_motion / sigma_m, among, -np.eye(3) / sigma_m)


def _pixel_rows(point: SeenPoint, known: KnownPoints, state: State, index: Index) -> PointRows:
    anchor, count = known.anchor, len(point.seen_px)
    off, rows, by_shift = np.zeros(2 * count), np.zeros((2 * count, 6 * count)), np.zeros((2 * count, 3))
    among: list[int] = []
    for number, (camera, pixel) in enumerate(point.seen_px.items()):
        pose, own = state.cameras[camera], slice(2 * number, 2 * number + 2)
        in_camera = _in_camera(point.world_m, pose)
        at_px, by_point = project(known.cameras[camera].intrinsics, in_camera[None])
        off[own] = at_px[0] - pixel
        rows[own, 6 * number : 6 * number + 6] = by_point[0] @ np.concatenate(
            [cross_matrix(in_camera), -np.eye(3)], axis=1
        )
        by_shift[own] = by_point[0] @ pose[:3, :3].T
        among += range(index.cameras[camera].start, index.cameras[camera].stop)
    variance = anchor.sigma_px**2 * np.eye(2 * count) + anchor.sigma_m**2 * by_shift @ by_shift.T
    root = np.linalg.inv(np.linalg.cholesky(variance))
    return PointRows(root @ off, root @ rows, np.array(among, dtype=np.int64), root @ by_shift)


def _in_camera(point_in_world: Array, world_from_camera: Array) -> Array:
    pose = invert_rigid(world_from_camera)
    return np.asarray(pose[:3, :3] @ point_in_world + pose[:3, 3])
