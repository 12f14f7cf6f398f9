"""Balls in an empty hall, by closed formulas: volume and surface of such a scene grow one without the other."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, Intrinsics

RING_M, UP_M = 3.5, 1.0
"""How far from the middle cameras stand, and how high [m]."""
WALL_M = 9.0
"""How far away they see the hall's walls [m]."""


def ring_cameras(count: int, width: int, height: int) -> tuple[DepthCamera, ...]:
    """Cameras around a hall that look at its middle.

    Args:
        count: how many.
        width, height: of their images [px].
    """
    lens = Intrinsics(0.5 * width, 0.5 * width, (width - 1) / 2, (height - 1) / 2)
    return tuple(
        DepthCamera(f"cam{n:02d}", width, height, _looking_in(2 * np.pi * n / count), lens)
        for n in range(count)
    )


def _looking_in(angle: float) -> NDArray[np.float64]:
    eye = np.array([RING_M * np.cos(angle), RING_M * np.sin(angle), UP_M])
    forward = -eye / np.linalg.norm(eye)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = eye
    return pose


def random_balls(count: int, radius_m: float, half_m: float, seed: int = 0) -> NDArray[np.float64]:
    """Balls at random places of a cube about the middle, shape (count, 4): centre and radius [m].

    Args:
        count: how many.
        radius_m: of each [m].
        half_m: half the cube's edge [m].
        seed: of the places.
    """
    centres = np.random.default_rng(seed).uniform(-half_m + radius_m, half_m - radius_m, (count, 3))
    return np.column_stack([centres, np.full(count, radius_m)])


def depth_of_balls(camera: DepthCamera, balls: NDArray[np.float64]) -> NDArray[np.float32]:
    """What a camera sees of balls, and of walls far behind them, shape (height, width) [m].

    Args:
        camera: without distortion, of planar depth.
        balls: shape (n, 4): centre and radius [m].
    """
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    rays = np.stack(np.broadcast_arrays(x[None, :], y[:, None], np.float64(1.0)), axis=-1)
    depth = np.full(rays.shape[:2], WALL_M)
    square = (rays * rays).sum(axis=-1)
    middles = balls[:, :3] @ camera.camera_from_world[:3, :3].T + camera.camera_from_world[:3, 3]
    for middle, radius in zip(middles, balls[:, 3], strict=True):
        along = rays @ middle
        under = along * along - square * (middle @ middle - radius * radius)
        near = (along - np.sqrt(np.maximum(under, 0.0))) / square
        depth = np.where((under >= 0) & (near > 0) & (near < depth), near, depth)
    return depth.astype(np.float32)
