"""Whether a point lies in a solid: a camera there would see the solid's inside and call it free."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CameraError, InputError
from elbowroom.geometry import DepthCamera
from elbowroom.simulate.cameras import Walls
from elbowroom.simulate.solid import Solid

CLEAR_M = 0.05
"""A camera that is moved out of a solid keeps so far from all others but walls, floor and ceiling [m]."""
USUAL = Walls()
STEPS = 400
"""Places along the walls that are tried, evenly round."""


def winding_number(solid: Solid, point_in_world: NDArray[np.float64]) -> float:
    """How often a closed mesh winds about a point: 0 outside, 1 inside (solid angles, Van Oosterom 1983)."""
    a, b, c = np.moveaxis(solid.vertices_in_world[solid.mesh.faces] - point_in_world, 1, 0)
    la, lb, lc = (np.linalg.norm(corner, axis=1) for corner in (a, b, c))
    volume = np.sum(a * np.cross(b, c), axis=1)
    plane = la * lb * lc + np.sum(a * b, 1) * lc + np.sum(b * c, 1) * la + np.sum(c * a, 1) * lb
    return float(np.arctan2(volume, plane).sum() / (2 * np.pi))


def solid_about(point_in_world: NDArray[np.float64], solids: Iterable[Solid]) -> Solid | None:
    """The first solid that a point lies in; None: none.

    Args:
        point_in_world: shape (3,) [m].
        solids: those without an inside are passed over.
    """
    for solid in solids:
        vertices = solid.vertices_in_world if solid.has_inside else np.zeros((0, 3))
        if not len(vertices):
            continue
        within = (point_in_world > vertices.min(axis=0)) & (point_in_world < vertices.max(axis=0))
        if within.all() and abs(winding_number(solid, point_in_world)) > 0.5:
            return solid
    return None


def check_outside(cameras: Sequence[DepthCamera], solids: Iterable[Solid]) -> None:
    """Makes sure that no camera is in a solid.

    Raises:
        InputError: one is; names both.
    """
    every = tuple(solids)
    for camera in cameras:
        centre = camera.centre_in_world
        solid = _solid_about(tuple(centre.tolist()), every)
        if solid is not None:
            place = ", ".join(f"{x:.2f}" for x in centre)
            raise InputError(
                f"camera {camera.name} at ({place}) m is inside {solid.name!r}; move that object, or hang the "
                "cameras elsewhere"
            )


@lru_cache(maxsize=4096)
def _solid_about(point_in_world: tuple[float, ...], solids: tuple[Solid, ...]) -> Solid | None:
    """The same, kept: solids that never move are the same objects in every moment of a room."""
    return solid_about(np.array(point_in_world), solids)


def hung_clear(
    cameras: Sequence[DepthCamera], solids: Sequence[Solid], walls: Walls = USUAL
) -> tuple[DepthCamera, ...]:
    """The cameras; those that would hang inside a solid, as a cabinet, hang beside it at the same height instead.

    Such a camera moves along the walls to the nearest place that is in no solid and not right before one.

    Args:
        cameras: as of `wall_cameras`.
        solids: closed, in the world.
        walls: along which they hang, and where those that are moved look.

    Raises:
        CameraError: all along the walls there is no such place.
    """
    return tuple(
        camera
        if solid_about(camera.centre_in_world, solids) is None
        else replace(camera, world_from_camera=_beside(camera, solids, walls))
        for camera in cameras
    )


def _beside(camera: DepthCamera, solids: Sequence[Solid], walls: Walls) -> NDArray[np.float64]:
    """The pose at the nearest place along the walls that is clear."""
    here = camera.centre_in_world
    poses = [walls.world_from_camera(step / STEPS, float(here[2])) for step in range(STEPS)]
    for pose in sorted(poses, key=lambda pose: float(np.linalg.norm(pose[:3, 3] - here))):
        if _is_clear(pose[:3, 3], solids):
            return pose
    raise CameraError(
        f"camera {camera.name}: at {here.round(2).tolist()} m it is inside {_name_about(here, solids)}, and at that "
        "height there is no place along the walls that is clear"
    )


def _is_clear(place_in_world: NDArray[np.float64], solids: Sequence[Solid]) -> bool:
    """Whether a place is in no solid, and so far from each as a camera needs."""
    around = [
        place_in_world,
        *(place_in_world + step for step in CLEAR_M * np.vstack([np.eye(3), -np.eye(3)])),
    ]
    return all(solid_about(point, solids) is None for point in around)


def _name_about(point_in_world: NDArray[np.float64], solids: Sequence[Solid]) -> str:
    solid = solid_about(point_in_world, solids)
    return "nothing" if solid is None else repr(solid.name)
