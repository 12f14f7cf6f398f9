"""Depth images to free space: three cameras look at a floor with a box on it.

    python examples/01_first_free_space.py

Nothing but numbers goes in: where each camera is, how it sees, and one depth image of each.
"""

from pathlib import Path

import numpy as np

import elbowroom as er
from elbowroom.geometry import looking_at
from elbowroom.view import section

BOX_M = np.array([[-0.2, -0.2, 0.0], [0.2, 0.2, 0.4]])
"""Least and greatest corner of the box that stands on the floor."""
PLACES_M = {"north": (0.0, 2.0, 1.2), "east": (2.0, 0.0, 1.2), "above": (0.3, 0.3, 3.0)}


def depth_image(camera: er.DepthCamera) -> np.ndarray:
    """What a sensor would deliver: planar depth of the floor and of the box, shape (height, width) [m]."""
    k = camera.intrinsics
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)
    way, start = rays @ camera.world_from_camera[:3, :3].T, camera.centre_in_world
    with np.errstate(divide="ignore"):
        floor = np.where(way[..., 2] < 0, -start[2] / way[..., 2], np.inf)
        faces = (BOX_M[:, None, None] - start) / way
    enter, leave = faces.min(axis=0).max(axis=-1), faces.max(axis=0).min(axis=-1)
    nearest = np.minimum(floor, np.where((enter < leave) & (enter > 0), enter, np.inf))
    return np.where(np.isfinite(nearest), nearest, 0.0)  # 0 is "no return": it frees nothing


# the space that is watched: 2 x 2 x 1.5 m, in voxels of 5 cm
grid = er.VoxelGrid(origin_m=(-1, -1, 0), shape=(40, 40, 30), voxel_size_m=0.05)
lens = er.Intrinsics(fx=80, fy=80, cx=79.5, cy=59.5)  # 160 x 120 pixels, 90 degrees wide
cameras = [
    er.DepthCamera(name, 160, 120, world_from_camera=looking_at(place, (0, 0, 0.4)), intrinsics=lens)
    for name, place in PLACES_M.items()
]
frames = [er.DepthFrame(camera.name, stamp_ns=0, depth_m=depth_image(camera)) for camera in cameras]

space = er.reconstruct(grid, cameras, frames)

# bool arrays of the grid's shape, index order x, y, z; everything but free is blocked
for name in ("free", "surface", "unseen"):
    print(f"{name:8s} {100 * getattr(space, name).mean():5.1f} % of the voxels")

# nobody can look into the box, so it is not free, although no camera measured anything inside it
print(space.explain((0.0, 0.0, 0.2)))
print(space.explain((0.0, 0.6, 0.8)))

section(space, "z", 0.22, cameras=cameras).save(Path("01_first_free_space.png"))
print("drawn in 01_first_free_space.png")
