"""From where a picture is taken, and where in it things come to lie."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import looking_at

Array = NDArray[np.float64]
Standard = Literal["iso", "top", "front", "side"]
"""Views by name: over a corner, from above, along y, along x; the last three in parallel projection, to scale."""
FROM: dict[str, tuple[float, float, float]] = {
    "iso": (-0.62, -0.75, 0.62),
    "top": (0.0, 0.0, 1.0),
    "front": (0.0, -1.0, 0.0),
    "side": (-1.0, 0.0, 0.0),
}
"""By view, from what side of the room's middle it looks."""
FIELD_DEG = 42.0
"""Of views in perspective, across the wider side [deg]."""
FILLED = 0.88
"""What is to be seen fills so much of a picture at most."""
FITTED = 6
"""After so many corrections a view in perspective is as near as it may be."""
SIDE_PX = (64, 4096)
"""The least and the greatest side of a picture [px]."""
NEAR_M = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """A pinhole camera or a parallel projection.

    Args:
        world_from_view: pose, shape (4, 4); x right, y down, z forward.
        width, height: of the picture [px].
        scale: of a pinhole its focal length [px], else pixels of a metre.
        is_parallel: whether all rays run side by side.
    """

    world_from_view: Array
    width: int
    height: int
    scale: float
    is_parallel: bool = False

    @property
    def eye_m(self) -> Array:
        """Where it looks from, shape (3,), world frame [m]."""
        return self.world_from_view[:3, 3]

    def rays(self, rows: slice, smooth: int) -> tuple[Array, Array]:
        """Origins and directions of length 1 of the rays of some rows of pixels, shape (n, 3), world frame [m].

        Args:
            rows: of pixels.
            smooth: rays per side of a pixel.
        """
        u = (np.arange(self.width * smooth) + 0.5) / smooth - self.width / 2
        v = (np.arange(rows.start * smooth, rows.stop * smooth) + 0.5) / smooth - self.height / 2
        across, down = np.meshgrid(u / self.scale, v / self.scale)
        turn, eye = self.world_from_view[:3, :3], self.eye_m
        plane = np.stack([across, down, np.zeros_like(across)], axis=-1).reshape(-1, 3)
        if self.is_parallel:
            return plane @ turn.T + eye, np.broadcast_to(turn[:, 2], plane.shape)
        plane[:, 2] = 1.0
        plane /= np.linalg.norm(plane, axis=1, keepdims=True)
        return np.broadcast_to(eye, plane.shape), plane @ turn.T

    def project(self, points_in_world: Array) -> Array:
        """Column and row, from the upper left corner [px], and depth [m] of points, shape (n, 3).

        What lies behind a pinhole has a depth below zero, and its column and row mean nothing.
        """
        points = (np.atleast_2d(points_in_world) - self.eye_m) @ self.world_from_view[:3, :3]
        depth = points[:, 2]
        scale = self.scale if self.is_parallel else self.scale / np.maximum(depth, NEAR_M)
        middle = (self.width / 2, self.height / 2)
        return np.stack([points[:, 0] * scale + middle[0], points[:, 1] * scale + middle[1], depth], axis=1)


def looking(
    eye_m: Sequence[float], target_m: Sequence[float], size_px: tuple[int, int], field_deg: float = FIELD_DEG
) -> Viewpoint:
    """A view in perspective from one point to another.

    Args:
        eye_m, target_m: world frame [m].
        size_px: width and height of the picture.
        field_deg: field of view across its wider side [deg].

    Raises:
        InputError: both points are the same, or a size or field that no picture has.
    """
    width, height = checked_size(size_px)
    if not 1 <= field_deg <= 150:
        raise InputError(f"field of view: is {field_deg:g} degrees, must be from 1 to 150")
    pose = looking_at(eye_m, target_m, error=InputError)
    return Viewpoint(pose, width, height, max(width, height) / 2 / np.tan(np.radians(field_deg) / 2))


def standard(name: str, box_m: Array, size_px: tuple[int, int]) -> Viewpoint:
    """A view by name that holds all of a box.

    Args:
        name: one of `FROM`.
        box_m: least and greatest corner, shape (2, 3), world frame [m].
        size_px: width and height of the picture.

    Raises:
        InputError: no such view, or a size that no picture has.
    """
    if name not in FROM:
        raise InputError(f"view: {name!r} is unknown, known are {', '.join(FROM)}")
    middle, size = box_m.mean(axis=0), float(np.linalg.norm(box_m[1] - box_m[0]))
    eye = middle + np.array(FROM[name]) * max(size, NEAR_M) * 2
    view = looking(eye.tolist(), middle.tolist(), size_px)
    corners = np.stack(np.meshgrid(*box_m.T, indexing="ij"), axis=-1).reshape(8, 3)
    half = np.array([view.width, view.height]) / 2 * FILLED
    if name != "iso":
        across = np.abs((corners - view.eye_m) @ view.world_from_view[:3, :2]).max(axis=0)
        return replace(view, scale=float((half / np.maximum(across, NEAR_M)).min()), is_parallel=True)
    for _ in range(FITTED):
        view = _nearer(view, corners, half)
    return view


def _nearer(view: Viewpoint, corners: Array, half: Array) -> Viewpoint:
    """The view moved so that what it sees lies in the middle and fills what may be filled, more nearly so each time."""
    pose = view.world_from_view.copy()
    seen = view.project(corners)
    middle = (seen[:, :2].max(axis=0) + seen[:, :2].min(axis=0)) / 2 - (view.width / 2, view.height / 2)
    pose[:3, 3] += pose[:3, :2] @ (middle / view.scale * seen[:, 2].mean())
    points = (corners - pose[:3, 3]) @ pose[:3, :3]
    # so near that the corner that lies farthest out touches the edge of what may be filled
    back = float((np.abs(points[:, :2]) * view.scale / half - points[:, 2:]).max())
    pose[:3, 3] -= back * pose[:3, 2]
    return replace(view, world_from_view=pose)


def checked_size(size_px: tuple[int, int]) -> tuple[int, int]:
    """Width and height, if a picture can have them.

    Raises:
        InputError: too small or too large.
    """
    least, most = SIDE_PX
    if not all(least <= side <= most for side in size_px):
        raise InputError(
            f"size: {size_px[0]}x{size_px[1]} is no size of a picture; each side must be {least} to {most} px"
        )
    return size_px
