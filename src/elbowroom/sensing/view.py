"""Which places lie in a camera's field of view, as far as reconstruction can use it."""

import numpy as np
from numpy.typing import NDArray

from elbowroom.geometry import DepthCamera
from elbowroom.sensing.rectify import index_map_of, rectified


def in_view(camera: DepthCamera, points_in_world: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether points lie within a camera's image and range of depth, shape (n,).

    Of a distorted camera it is the pinhole image that counts, where the lens model fills it: no more is used of it.

    Args:
        camera: of the room.
        points_in_world: shape (n, 3), world frame [m].
    """
    k = camera.intrinsics
    in_camera = (points_in_world - camera.centre_in_world) @ camera.world_from_camera[:3, :3]
    z = in_camera[:, 2]
    depth = z if camera.depth_kind == "planar" else np.linalg.norm(in_camera, axis=1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        u, v = k.fx * (in_camera[:, 0] / z) + k.cx, k.fy * (in_camera[:, 1] / z) + k.cy
    within = (np.abs(u - (camera.width - 1) / 2) <= camera.width / 2) & (
        np.abs(v - (camera.height - 1) / 2) <= camera.height / 2
    )
    within &= (z > 0) & (depth >= camera.min_depth_m) & (depth <= camera.max_depth_m)
    mask = rectified(camera).mask
    if mask is not None:
        within[within] = ~mask[_pixels(camera, u[within], v[within])]
    if k.is_distorted:
        filled = index_map_of(k, camera.width, camera.height).first_u >= 0
        within[within] = filled[_pixels(camera, u[within], v[within])]
    return np.asarray(within)


def _pixels(
    camera: DepthCamera, u: NDArray[np.float64], v: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Rows and columns of the pixels about places in an image."""
    row = np.clip(np.rint(v), 0, camera.height - 1).astype(np.intp)
    return row, np.clip(np.rint(u), 0, camera.width - 1).astype(np.intp)
