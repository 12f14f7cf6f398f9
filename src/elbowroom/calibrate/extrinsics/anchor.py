"""What fixes the world's frame: one pose of the board or one camera, which define it, or points measured in it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import CalibrationError
from elbowroom.geometry import DepthCamera, invert_rigid
from elbowroom.geometry.lens import directions

Array = NDArray[np.float64]
POINT_SIGMA_PX = 0.5
"""Of the pixels at which points are said to be seen."""
POINT_SIGMA_M = 0.002
"""Of measured places: what a total station reaches in a room, or a tape with much care [m]."""
LEAST_WIDTH_M = 0.05
"""Points lie in a line if none is farther off it than this [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardAnchor:
    """The world's frame is that in which the board lies so in one pose.

    Args:
        pose: number of the pose.
        world_from_board: shape (4, 4).
    """

    pose: int
    world_from_board: Array


@dataclass(frozen=True, slots=True)
class CameraAnchor:
    """The world's frame is that in which one camera is where its pose says.

    Args:
        camera: name.
    """

    camera: str


@dataclass(frozen=True, slots=True, eq=False)
class SeenPoint:
    """A point of measured place that images show.

    Args:
        name: of the point.
        world_m: where it was measured, shape (3,) [m].
        seen_px: where cameras see it, u then v, shape (2,) [px], by camera.
    """

    name: str
    world_m: Array
    seen_px: Mapping[str, Array]


@dataclass(frozen=True, slots=True, eq=False)
class BoardCorner:
    """A corner of the board, whose place was measured while the board stood in one of its poses.

    Args:
        name: of the point.
        world_m: where it was measured, shape (3,) [m].
        pose: number of the pose.
        board_m: where the corner is on the board, shape (3,), board frame [m].
    """

    name: str
    world_m: Array
    pose: int
    board_m: Array


KnownPoint = SeenPoint | BoardCorner


@dataclass(frozen=True, slots=True, eq=False)
class PointsAnchor:
    """Points whose places in the world were measured, each with an error of its own.

    Args:
        points: at least three, not in a line, each a corner of the board or seen by two cameras or more.
        sigma_m: of each measured coordinate [m].
        sigma_px: of the pixels.
    """

    points: tuple[KnownPoint, ...]
    sigma_m: float = POINT_SIGMA_M
    sigma_px: float = POINT_SIGMA_PX

    def on_poses(self, poses: Collection[int]) -> "PointsAnchor":
        """Without corners of the board in other poses; all points if that would leave fewer than three."""
        kept = tuple(p for p in self.points if not isinstance(p, BoardCorner) or p.pose in poses)
        return self if len(kept) < 3 else replace(self, points=kept)


Anchor = BoardAnchor | CameraAnchor | PointsAnchor


def world_from_base(
    anchor: Anchor,
    cameras: Mapping[str, DepthCamera],
    base_from_camera: Mapping[str, Array],
    base_from_board: Mapping[int, Array],
) -> Array:
    """Where the frame of a first solution lies in the world, shape (4, 4).

    Args:
        anchor: what fixes the world.
        cameras: by name, as the site has them.
        base_from_camera: of the first solution, by name, shape (4, 4).
        base_from_board: of the first solution, by pose, shape (4, 4).

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
    return _from_points(anchor, cameras, base_from_camera, base_from_board)


def _from_points(
    anchor: PointsAnchor,
    cameras: Mapping[str, DepthCamera],
    base_from_camera: Mapping[str, Array],
    base_from_board: Mapping[int, Array],
) -> Array:
    in_base, in_world = [], []
    for point in anchor.points:
        if isinstance(point, BoardCorner):
            if point.pose not in base_from_board:
                raise CalibrationError(
                    f"point {point.name}: is a corner of the board in pose {point.pose}, which was seen by no camera; "
                    "show the board there again, or take the point out of calibration.world"
                )
            pose = base_from_board[point.pose]
            in_base.append(pose[:3, :3] @ point.board_m + pose[:3, 3])
            in_world.append(point.world_m)
            continue
        unknown = [camera for camera in point.seen_px if camera not in cameras]
        if unknown:
            raise CalibrationError(
                f"point {point.name}: camera {unknown[0]} is unknown; cameras are {', '.join(cameras)}"
            )
        if len(point.seen_px) > 1:
            in_base.append(_crossing(point, cameras, base_from_camera))
            in_world.append(point.world_m)
    return _fitted(in_base, in_world)


def _crossing(
    point: SeenPoint, cameras: Mapping[str, DepthCamera], base_from_camera: Mapping[str, Array]
) -> Array:
    """The point nearest to the rays of all cameras, base frame."""
    left, right = np.zeros((3, 3)), np.zeros(3)
    for camera, pixel in point.seen_px.items():
        ray = np.append(directions(cameras[camera].intrinsics, pixel[None], f"camera {camera}")[0], 1.0)
        pose = base_from_camera[camera]
        along = pose[:3, :3] @ (ray / np.linalg.norm(ray))
        across = np.eye(3) - np.outer(along, along)
        left += across
        right += across @ pose[:3, 3]
    return np.asarray(np.linalg.solve(left, right), dtype=np.float64)


def _fitted(in_base: Sequence[Array], in_world: Sequence[Array]) -> Array:
    """The rigid transform that brings points of one frame nearest to those of the other (Kabsch 1976)."""
    if len(in_base) < 3:
        raise CalibrationError(
            f"{len(in_base)} points of known place are corners of the board or seen by two cameras or more; "
            "at least 3 are needed to fix the world"
        )
    base, world = np.array(in_base), np.array(in_world)
    if np.linalg.svd(world - world.mean(axis=0))[1][1] < LEAST_WIDTH_M:
        raise CalibrationError("the points of known place lie in a line; name one that lies beside it")
    middle_of_base, middle_of_world = base.mean(axis=0), world.mean(axis=0)
    u, _, vt = np.linalg.svd((world - middle_of_world).T @ (base - middle_of_base))
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt
    result = np.eye(4)
    result[:3, :3] = turn
    result[:3, 3] = middle_of_world - turn @ middle_of_base
    return result
