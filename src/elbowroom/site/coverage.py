"""How much of a grid lies in the fields of view of how many cameras, by geometry alone."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.sensing.view import in_view

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
