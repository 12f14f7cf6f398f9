"""A plate and what is behind it as a picture: 1 on the plate, 0 beside it, in between where a pixel flies."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.boards.plate import Plate, View
from elbowroom.extras import package

Array = NDArray[np.float64]
GAP_M = 0.05
SIGMAS = 3.0
NEIGHBOURHOOD = 5


class NearFar(NamedTuple):
    """A part of the image about a plate; arrays have the part's shape (rows, columns).

    Fields:
        top, left: its first row and column in the image.
        near: 1 on the plate, 0 on what lies behind.
        known: False where there is no return, or something stands before the plate.
        x, y: X/Z and Y/Z of the pixels.
        off_plane: measured planar depth less that of the plane, in sigmas.
    """

    top: int
    left: int
    near: Array
    known: NDArray[np.bool_]
    x: Array
    y: Array
    off_plane: Array


def near_far(view: View, plate: Plate, reach_m: float) -> NearFar | None:
    """The near/far picture of all pixels whose rays meet the plate's plane within reach of its middle.

    Flying pixels of a time-of-flight camera lie between near and far by how much of each they see: so does their value.

    Args:
        view: the depth image.
        plate: the plane.
        reach_m: diagonal of the board [m].
    """
    top, left, rays = _about(view, plate, reach_m)
    inverse = rays @ plate.inverse
    plane_z = 1 / np.where(inverse > 1e-3, inverse, np.nan)
    with np.errstate(invalid="ignore"):
        within = ((rays * plane_z[..., None] - plate.centre_in_camera) ** 2).sum(axis=-1) < reach_m**2
    rows, columns = np.flatnonzero(within.any(axis=1)), np.flatnonzero(within.any(axis=0))
    if not len(rows):
        return None
    part = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    rays, within, plane = rays[part], within[part], plane_z[part]
    top, left = top + int(rows[0]), left + int(columns[0])
    z = view.z[top : top + len(rays), left : left + rays.shape[1]].astype(np.float64)
    sigma = view.sigma(np.nan_to_num(plane, nan=1.0))
    off = np.where((z > 0) & within, z - plane, np.nan)
    known = np.isfinite(off) & (off > -4 * sigma)
    band = SIGMAS * sigma
    window = np.ones((NEIGHBOURHOOD, NEIGHBOURHOOD), np.uint8)
    farthest = package("cv2").dilate(np.where(known, off, 0.0), window)
    depth_of_hole = np.maximum(farthest, np.maximum(GAP_M, 2 * band))
    near = 1 - np.clip((np.nan_to_num(off) - band) / (depth_of_hole - band), 0, 1)
    return NearFar(
        top,
        left,
        np.where(known, near, 0.5),
        known,
        rays[..., 0],
        rays[..., 1],
        np.where(known, np.nan_to_num(off) / sigma, np.inf),
    )


def _about(view: View, plate: Plate, reach_m: float) -> tuple[int, int, Array]:
    """First row and column of the part of the image about a plate, and its rays, shape (rows, columns, 3)."""
    x, y, z = plate.centre_in_camera
    wide = 2 * reach_m / max(z - reach_m, 0.3)
    rows = (view.rays.y_range[1] >= y / z - wide) & (view.rays.y_range[0] <= y / z + wide)
    columns = (view.rays.x_range[1] >= x / z - wide) & (view.rays.x_range[0] <= x / z + wide)
    first = int(np.argmax(rows)), int(np.argmax(columns))
    part = (slice(first[0], first[0] + int(rows.sum())), slice(first[1], first[1] + int(columns.sum())))
    xs, ys = view.rays.x[part].astype(np.float64), view.rays.y[part].astype(np.float64)
    return *first, np.stack([xs, ys, np.ones_like(xs)], axis=-1)


def cropped(picture: NearFar, camera_from_board: Array, outline_in_board: Array) -> NearFar:
    """The part of a picture about a board's outline.

    Args:
        picture: near and far.
        camera_from_board: about where the board is, shape (4, 4).
        outline_in_board: corners of the plate, shape (n, 3) [m].
    """
    points = outline_in_board @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    slack = 0.03 * (np.ptp(x) + np.ptp(y))
    inside = (picture.x > x.min() - slack) & (picture.x < x.max() + slack)
    inside &= (picture.y > y.min() - slack) & (picture.y < y.max() + slack)
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    if len(rows) < 2 or len(columns) < 2:
        return picture
    part = (slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1))
    return NearFar(
        picture.top + int(rows[0]),
        picture.left + int(columns[0]),
        picture.near[part],
        picture.known[part],
        picture.x[part],
        picture.y[part],
        picture.off_plane[part],
    )
