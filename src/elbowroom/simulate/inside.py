"""Whether a point lies in a solid: a camera there would see the solid's inside and call it free."""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import InputError
from elbowroom.geometry import DepthCamera, looking_at
from elbowroom.simulate.solid import Solid


def winding_number(solid: Solid, point_in_world: NDArray[np.float64]) -> float:
    """How often a closed mesh winds about a point: 0 outside, 1 inside (solid angles, Van Oosterom 1983)."""
    a, b, c = np.moveaxis(solid.vertices_in_world[solid.mesh.faces] - point_in_world, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.sum(a * np.cross(b, c), axis=1)
    plane = la * lb * lc + np.sum(a * b, 1) * lc + np.sum(b * c, 1) * la + np.sum(c * a, 1) * lb
    return float(np.arctan2(volume, plane).sum() / (2 * np.pi))


def check_outside(cameras: Sequence[DepthCamera], solids: Iterable[Solid]) -> None:
    """Makes sure that no camera is in a solid.

    Raises:
        InputError: one is; names both.
    """
    for solid in solids:
        vertices = solid.vertices_in_world
        lower, upper = vertices.min(axis=0), vertices.max(axis=0)
        for camera in cameras:
            centre = camera.centre_in_world
            if (centre > lower).all() and (centre < upper).all() and abs(winding_number(solid, centre)) > 0.5:
                place = ", ".join(f"{x:.2f}" for x in centre)
                raise InputError(
                    f"camera {camera.name} at ({place}) m is inside {solid.name!r}; move that object, or hang the "
                    "cameras elsewhere"
                )


def hung_clear(
    cameras: Sequence[DepthCamera], solids: Sequence[Solid], above_m: float, aim_m: float = 1.1
) -> tuple[DepthCamera, ...]:
    """The cameras; those that would hang inside a solid, as a cabinet, hang above it instead.

    Args:
        cameras: as of `wall_cameras`.
        solids: closed, in the world.
        above_m: height at which they hang then [m].
        aim_m: height at which these look at the room's middle axis [m].
    """
    clear = []
    for camera in cameras:
        try:
            check_outside([camera], solids)
        except InputError:
            x, y, _ = camera.centre_in_world
            camera = replace(
                camera, world_from_camera=looking_at((float(x), float(y), above_m), (0.0, 0.0, aim_m))
            )
        clear.append(camera)
    return tuple(clear)
