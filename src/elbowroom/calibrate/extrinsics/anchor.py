"""What fixes the world's frame: the board in a known pose, named points, or one camera that stays where it is."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.calibrate.lens import directions
from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, invert_rigid

Array = NDArray[np.float64]
POINT_SIGMA_PX = 0.5
"""Of the pixels at which named points are said to be seen."""
LEAST_WIDTH_M = 0.05
"""Named points lie in a line if none is farther off it than this [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardAnchor:
    """In one pose it is known where the board is.

    Args:
        pose: number of the pose.
        world_from_board: shape (4, 4).
    """

    pose: int
    world_from_board: Array


@dataclass(frozen=True, slots=True)
class CameraAnchor:
    """One camera is where its pose says.

    Args:
        camera: name.
    """

    camera: str


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """A named point in one camera's image.

    Args:
        name: of the point.
        world_m: where it is, shape (3,) [m].
        camera: who sees it.
        pixel: where, u then v [px].
    """

    name: str
    world_m: Array
    camera: str
    pixel: Array


@dataclass(frozen=True, slots=True, eq=False)
class PointsAnchor:
    """Points whose place in the world is known.

    Args:
        sightings: at least three points, not in a line, each seen by two cameras or more.
        sigma_px: of the pixels.
    """

    sightings: tuple[Sighting, ...]
    sigma_px: float = POINT_SIGMA_PX


Anchor = BoardAnchor | CameraAnchor | PointsAnchor


def world_from_base(
    anchor: Anchor,
    cameras: Mapping[str, DepthCamera],
    base_from_camera: Mapping[str, Array],
    base_from_board: Mapping[int, Array],
) -> Array:
    """Where the frame of a first solution lies in the world, shape (4, 4).

    Raises:
        CalibrationError: what shall fix the world was not seen, or does not fix it.
    """
    if isinstance(anchor, BoardAnchor):
        if anchor.pose not in base_from_board:
            raise CalibrationError(
                f"pose {anchor.pose}, in which the board's place is known, was seen by no camera; "
                "lay the board where at least one sees all of it"
            )
        return np.asarray(anchor.world_from_board @ invert_rigid(base_from_board[anchor.pose]))
    if isinstance(anchor, CameraAnchor):
        if anchor.camera not in cameras:
            raise CalibrationError(
                f"camera {anchor.camera}, which shall fix the world, is unknown; cameras are {', '.join(cameras)}"
            )
        camera = cameras[anchor.camera]
        return np.asarray(camera.world_from_camera @ invert_rigid(base_from_camera[anchor.camera]))
    return _from_points(anchor, cameras, base_from_camera)


def _from_points(
    anchor: PointsAnchor, cameras: Mapping[str, DepthCamera], base_from_camera: Mapping[str, Array]
) -> Array:
    seen_by: dict[str, list[Sighting]] = defaultdict(list)
    for sighting in anchor.sightings:
        if sighting.camera not in cameras:
            raise CalibrationError(
                f"point {sighting.name}: camera {sighting.camera} is unknown; cameras are {', '.join(cameras)}"
            )
        seen_by[sighting.name].append(sighting)
    in_base, in_world = [], []
    for sightings in seen_by.values():
        if len({sighting.camera for sighting in sightings}) > 1:
            in_base.append(_crossing(sightings, cameras, base_from_camera))
            in_world.append(sightings[0].world_m)
    if len(in_base) < 3:
        raise CalibrationError(
            f"{len(in_base)} named points are seen by two cameras or more; at least 3 are needed to fix the world"
        )
    base, world = np.array(in_base), np.array(in_world)
    if np.linalg.svd(world - world.mean(axis=0))[1][1] < LEAST_WIDTH_M:
        raise CalibrationError("the named points lie in a line; name one that lies beside it")
    found = _fitted(base, world)
    off = np.linalg.norm(base @ found[:3, :3].T + found[:3, 3] - world, axis=1)
    if off.max() > 0.1:
        name = [name for name, seen in seen_by.items() if len({s.camera for s in seen}) > 1][
            int(off.argmax())
        ]
        raise CalibrationError(
            f"point {name}: lies {off.max() * 1e3:.0f} mm from where the cameras see it when all points are fitted; "
            "check its world_m and seen_px"
        )
    return found


def _crossing(
    sightings: list[Sighting], cameras: Mapping[str, DepthCamera], base_from_camera: Mapping[str, Array]
) -> Array:
    """The point nearest to the rays of all cameras, base frame."""
    left, right = np.zeros((3, 3)), np.zeros(3)
    for sighting in sightings:
        ray = np.append(directions(cameras[sighting.camera].intrinsics, sighting.pixel[None])[0], 1.0)
        pose = base_from_camera[sighting.camera]
        along = pose[:3, :3] @ (ray / np.linalg.norm(ray))
        across = np.eye(3) - np.outer(along, along)
        left += across
        right += across @ pose[:3, 3]
    return np.asarray(np.linalg.solve(left, right), dtype=np.float64)


def _fitted(base: Array, world: Array) -> Array:
    """The rigid transform that brings points of one frame nearest to those of the other (Kabsch 1976)."""
    middle_of_base, middle_of_world = base.mean(axis=0), world.mean(axis=0)
    u, _, vt = np.linalg.svd((world - middle_of_world).T @ (base - middle_of_base))
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    result = np.eye(4)
    result[:3, :3] = turn
    result[:3, 3] = middle_of_world - turn @ middle_of_base
    return result
