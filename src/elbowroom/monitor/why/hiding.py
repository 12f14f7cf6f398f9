"""What hides a place from a camera, and how far it would have to move aside for the camera to see the place."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.reconstruct.point_report import CameraSight
from elbowroom.reconstruct.sight import NEXT_TO_NOTHING_M
from elbowroom.reconstruct.source import ImageSource

FARTHEST_MOVE_M = 2.0
"""What would have to move farther is said to be in the way, and not by how much [m]."""
SPARE_PX = 2
"""Beside the voxel so many pixels are clear as well."""


@dataclass(frozen=True, slots=True)
class Hiding:
    """What hides a place from a camera.

    Args:
        camera: its name.
        distance_m: how far before the camera it begins, along the axis [m].
        is_machine: whether it is the machine itself.
        side: "left", "right", "up" or "down", as the camera sees it: where it would have to go; None: it reaches out of
            the image on all sides, or would have to go farther than `FARTHEST_MOVE_M`.
        shift_m: how far it would have to go there [m]; 0 without a side.
    """

    camera: str
    distance_m: float
    is_machine: bool
    side: str | None = None
    shift_m: float = 0.0


class _Window(NamedTuple):
    """Pixels about a place: first and last row, first and last column."""

    top: int
    bottom: int
    left: int
    right: int


def hiding_of(
    source: ImageSource, seen: CameraSight, place_in_world: tuple[float, float, float], edge_m: float
) -> Hiding | None:
    """What hides a voxel from a camera; None: nothing that the camera measured.

    Args:
        source: the images.
        seen: what the camera saw of the voxel.
        place_in_world: the voxel's centre [m].
        edge_m: of the voxel [m].
    """
    camera = next(one for one in source.images.cameras if one.name == seen.camera)
    image = source.images.least_m.get(seen.camera)
    if image is None or seen.reach_m is None:
        return None
    pixels, window = _window_of(camera, np.array(place_in_world), edge_m)
    limit_m = seen.reach_m[0] - seen.margin_m
    with np.errstate(invalid="ignore"):
        before = (image > 0) & (image < limit_m)
    inside = before[window.top : window.bottom + 1, window.left : window.right + 1]
    if not inside.any():
        return None
    depth = image[window.top : window.bottom + 1, window.left : window.right + 1][inside]
    distance_m = float(np.median(depth)) * pixels.planar
    is_machine = _explained(source, seen.camera, window, inside)
    side, shift_px = _aside(before, window)
    focal = camera.intrinsics.fx if side in ("left", "right") else camera.intrinsics.fy
    shift_m = shift_px * distance_m / focal
    if side is None or shift_m > FARTHEST_MOVE_M:
        return Hiding(seen.camera, distance_m, is_machine)
    return Hiding(seen.camera, distance_m, is_machine, side, shift_m)


class _Pixels(NamedTuple):
    """Where a place is in an image [px], and its planar depth over its depth of the camera's kind."""

    u: float
    v: float
    planar: float


def _window_of(camera: DepthCamera, place: NDArray[np.float64], edge_m: float) -> tuple[_Pixels, _Window]:
    in_camera = camera.camera_from_world[:3, :3] @ place + camera.camera_from_world[:3, 3]
    k = camera.intrinsics
    u, v = k.fx * in_camera[0] / in_camera[2] + k.cx, k.fy * in_camera[1] / in_camera[2] + k.cy
    reach = edge_m * 0.87 * max(k.fx, k.fy) / in_camera[2] + SPARE_PX
    planar = 1.0
    if camera.depth_kind == "radial":
        planar = float(in_camera[2] / np.linalg.norm(in_camera))
    rows, columns = (v - reach, v + reach), (u - reach, u + reach)
    return _Pixels(u, v, planar), _Window(
        max(round(rows[0]), 0),
        min(round(rows[1]), camera.height - 1),
        max(round(columns[0]), 0),
        min(round(columns[1]), camera.width - 1),
    )


def _explained(source: ImageSource, camera: str, window: _Window, inside: NDArray[np.bool_]) -> bool:
    """Whether most of what is before the place is the machine."""
    model = source.model_depth.get(camera)
    if model is None:
        return False
    own = np.abs(model[window.top : window.bottom + 1, window.left : window.right + 1]) >= NEXT_TO_NOTHING_M
    return bool(2 * np.count_nonzero(own & inside) > np.count_nonzero(inside))


def _aside(before: NDArray[np.bool_], window: _Window) -> tuple[str | None, int]:
    """The side to which what is before the window goes least far until it is clear, and how far [px].

    People and things go aside before they go up or down.
    """
    across = np.asarray(before[window.top : window.bottom + 1].any(axis=0))
    ways = {
        "left": _clear_of(across, window.left, window.right),
        "right": _clear_of(across[::-1], len(across) - 1 - window.right, len(across) - 1 - window.left),
    }
    if not any(ways.values()):
        down = np.asarray(before[:, window.left : window.right + 1].any(axis=1))
        ways = {
            "up": _clear_of(down, window.top, window.bottom),
            "down": _clear_of(down[::-1], len(down) - 1 - window.bottom, len(down) - 1 - window.top),
        }
    found = {side: far for side, far in ways.items() if far}
    if not found:
        return None, 0
    side = min(found, key=lambda one: found[one])
    return side, found[side]


def _clear_of(blocked: NDArray[np.bool_], first: int, last: int) -> int:
    """How far what blocks places `first` to `last` has to go towards the beginning until it blocks none of them.

    0: it goes on to the end of the line, so nobody can tell.
    """
    end = last
    while end < len(blocked) and (end <= last or blocked[end]):
        end += 1
    if end >= len(blocked):
        return 0
    inside = np.flatnonzero(blocked[first:end])
    return int(inside[-1]) + 1 if len(inside) else 0
