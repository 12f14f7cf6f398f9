"""A room of 4 x 4 x 2.8 m with a box in it, seen by four cameras: exact depth by closed formulas."""

import numpy as np

from elbowroom.evaluate.looks.scene import Scene, as_codes
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, looking_at

WIDTH, HEIGHT = 160, 120
ROOM = np.array([-2.0, -2.0, 0.0]), np.array([2.0, 2.0, 2.8])
BOX = np.array([0.2, -0.25, 0.0]), np.array([0.6, 0.25, 1.7])
EYES = {"ne": (1.8, 1.8, 2.4), "nw": (-1.8, 1.8, 2.4), "sw": (-1.8, -1.8, 2.4), "se": (1.8, -1.8, 2.4)}
GRID = VoxelGrid((-1.9, -1.9, 0.0), (38, 38, 22), 0.1)


def camera_at(name, eye, at=(0.0, 0.0, 0.8), **more):
    """A camera of 90 degrees at a place of the room."""
    return DepthCamera(name, WIDTH, HEIGHT, looking_at(eye, at), Intrinsics(80.0, 80.0, 79.5, 59.5), **more)


def cameras(**more):
    return tuple(camera_at(name, eye, **more) for name, eye in EYES.items())


def depth_of(camera, box=True):
    """Planar depth [m], shape (height, width)."""
    k, pose = camera.intrinsics, camera.world_from_camera
    v, u = np.mgrid[0 : camera.height, 0 : camera.width]
    rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones_like(u, float)], -1) @ pose[:3, :3].T
    near, far = _span(*BOX, pose[:3, 3], rays)
    depth = _span(*ROOM, pose[:3, 3], rays)[1]
    return np.where((near <= far) & (near > 0), np.minimum(depth, near), depth) if box else depth


def _span(lower, upper, eye, rays):
    with np.errstate(divide="ignore"):
        one, other = (lower - eye) / rays, (upper - eye) / rays
    return np.minimum(one, other).max(-1), np.maximum(one, other).min(-1)


def scene(unit_m=0.001, noise_m=0.0, seed=0, **more):
    """The room as a site brings it: raw images in a unit, as the site says."""
    random, seen = np.random.default_rng(seed), cameras(**more)
    codes = {}
    for camera in seen:
        depth = depth_of(camera)
        codes[camera.name] = as_codes(depth + noise_m * random.standard_normal(depth.shape), unit_m)
    return Scene("four corners", GRID, seen, codes, dict.fromkeys(codes, unit_m))
