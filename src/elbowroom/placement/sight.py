"""Which camera sees which voxel of a room with nothing in it but what is fixed, by the projection that carves.

A camera *sees* a voxel if its centre falls on a pixel, lies within the sensor's range, nothing fixed is in between,
and the pixel has a return: what lies behind is within range too. A ray that comes back from nowhere carves nothing.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera, VoxelGrid, bits
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.parallel import spread, threads
from elbowroom.placement.coarse import with_joined_pixels
from elbowroom.placement.fixed_room import FixedRoom, clear_sight
from elbowroom.reconstruct import carve
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import render

BACKGROUND_PX = 160
"""Pixels are joined as long as so many stay across: enough to know where the room behind returns."""
NO_MARGIN = Margin(sigmas=0.0, bias_m=0.0, lateral_px=0.0)


def sights(grid: VoxelGrid, cameras: Sequence[DepthCamera], room: FixedRoom | None) -> NDArray[np.bool_]:
    """Which camera sees which voxel's centre.

    Args:
        grid: the watched box.
        cameras: in any order.
        room: what blocks sight and gives returns; None: not known, so nothing blocks and every pixel returns.

    Returns:
        bool, shape (number of cameras, *grid.shape).

    Raises:
        CameraError: a camera inside a solid of the room, or a lens model that folds back within the image.
    """
    if room is not None:
        room.refuse_inside(tuple(cameras))
    seen = np.zeros((len(cameras), *grid.shape), dtype=np.bool_)
    corners = np.stack(
        np.meshgrid(*np.stack([grid.lower_m, grid.upper_m]).T, indexing="ij"), axis=-1
    ).reshape(8, 3)

    def one(number: int) -> None:
        camera = cameras[number]
        reached = _reached(grid, camera, room)
        if room is not None:
            blocking = room.blocking(camera.centre_in_world, corners)
            if len(blocking):
                index = np.argwhere(reached)
                clear = clear_sight(blocking, camera.centre_in_world, grid.centre_of(index))
                reached[tuple(index[~clear].T)] = False
        seen[number] = reached

    spread(one, range(len(cameras)))
    return seen


def _reached(grid: VoxelGrid, camera: DepthCamera, room: FixedRoom | None) -> NDArray[np.bool_]:
    """Voxels whose centre falls on a pixel that has a return, within range: carved from an image of the far end."""
    coarse = replace(
        with_joined_pixels(camera, BACKGROUND_PX), noise=None, margin=NO_MARGIN, flying_pixels=False
    )
    returned = np.ones((coarse.height, coarse.width), dtype=bool)
    if room is not None:
        (frame,) = render([coarse], room.moment, noise=False)
        returned = frame.depth_m > 0
    farthest = np.maximum(
        *(np.abs(corner - camera.centre_in_world) for corner in (grid.lower_m, grid.upper_m))
    )
    far_m = min(camera.max_depth_m, float(np.linalg.norm(farthest)) + 0.1)
    plain = replace(coarse, min_depth_m=0.0, max_depth_m=math.inf)
    reached = _nearer_than(grid, plain, np.where(returned, np.float32(far_m), np.float32(0)))
    if camera.min_depth_m > 0:
        reached &= ~_nearer_than(grid, plain, np.full(returned.shape, np.float32(camera.min_depth_m)))
    return reached


def _nearer_than(grid: VoxelGrid, camera: DepthCamera, depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Voxels whose centre lies before the depth of the pixel that it falls on, shape of the grid."""
    with threads(1):  # the cameras are spread already
        evidence = carve(grid, [camera], [DepthFrame(camera.name, 0, depth_m)], detail="point")
    return bits.unpack(evidence.through[0], grid)
