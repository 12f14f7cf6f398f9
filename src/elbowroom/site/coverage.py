"""How much of a grid lies in the fields of view of how many cameras, by geometry alone."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.geometry.lens import distorted

MOST_SAMPLES = 20_000


def views_per_voxel(grid: VoxelGrid, cameras: Sequence[DepthCamera]) -> NDArray[np.int64]:
    """By how many cameras voxel centres are within field of view and range, if nothing stood in between.

    Args:
        grid: the watched box; up to about `MOST_SAMPLES` of its voxels are taken, evenly.
        cameras: of the room.

    Returns:
        Number of cameras per voxel taken, shape (n,).
    """
    stride = max(1, int(np.ceil((grid.size / MOST_SAMPLES) ** (1 / 3))))
    index = np.stack(np.meshgrid(*(np.arange(n)[::stride] for n in grid.shape), indexing="ij"), axis=-1)
    centres_in_world = grid.centre_of(index.reshape(-1, 3))
    return sum(
        (in_view(camera, centres_in_world).astype(np.int64) for camera in cameras),
        start=np.zeros(len(centres_in_world), dtype=np.int64),
    )


def in_view(camera: DepthCamera, points_in_world: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether points lie within a camera's image and range of depth, shape (n,).

    Args:
        camera: of the room.
        points_in_world: shape (n, 3), world frame [m].
    """
    in_camera = (points_in_world - camera.centre_in_world) @ camera.world_from_camera[:3, :3]
    z = in_camera[:, 2]
    depth = z if camera.depth_kind == "planar" else np.linalg.norm(in_camera, axis=1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        u, v = distorted(camera.intrinsics, in_camera[:, 0] / z, in_camera[:, 1] / z)
    within = (np.abs(u - (camera.width - 1) / 2) <= camera.width / 2) & (
        np.abs(v - (camera.height - 1) / 2) <= camera.height / 2
    )
    return within & (z > 0) & (depth >= camera.min_depth_m) & (depth <= camera.max_depth_m)
