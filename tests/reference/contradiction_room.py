"""Four cameras in the corners of a room with a box as large as a person in it, and what each says of each other."""

import numpy as np

from elbowroom.evaluate.contradictions.rooms import RandomSite
from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.sensing import Snapshot
from reference.reconstruct_scenes import Scene, camera_at, frame_of

MARGIN = Margin(bias_m=0.01)
PERSON = (0.2, -0.25, 0.0, 0.6, 0.25, 1.7)
CHEST = (-1.2, 0.6, 0.0, -0.4, 1.4, 0.8)
WALLS = ((-2.0, -2.0, 0.0), (2.0, 2.0, 2.8))
CORNERS = {"ne": (1.8, 1.8, 2.4), "nw": (-1.8, 1.8, 2.3), "sw": (-1.8, -1.8, 2.4), "se": (1.8, -1.8, 2.2)}
GRID = VoxelGrid((-1.9, -1.9, 0.0), (19, 19, 11), 0.2)
SIZE, FOCAL = (160, 120), 80.0


def room_cameras(noise: NoiseModel | None = None, **more):
    return tuple(
        camera_at(name, eye, (0.1 * number, 0, 0.9), size=SIZE, focal=FOCAL, noise=noise, **more)
        for number, (name, eye) in enumerate(CORNERS.items())
    )


def room_scene(person: bool = True) -> Scene:
    return Scene(boxes=np.array([PERSON, CHEST] if person else [CHEST]), walls=WALLS)


def room_site(cameras=None) -> RandomSite:
    """Cameras as they are, and what they saw."""
    cameras = cameras or room_cameras()
    frames = [frame_of(camera, room_scene()) for camera in cameras]
    return RandomSite(0, cameras, Snapshot.taken(frames, None, 0), GRID, "exact", "room")


def naive_pairs(cameras, frames, margin, pixels, wide_m):
    """Of exact planar pinhole cameras: what each sees of each other's points, point by point.

    Args:
        cameras, frames: in one order.
        margin: of all, its bias alone.
        pixels: by camera, columns and rows of points that are asked about.
        wide_m: a function of both depths: beyond it they differ.

    Returns:
        through, agrees, hidden: (measured by, looked at by).
    """
    counts = np.zeros((3, len(cameras), len(cameras)), dtype=int)
    for a, camera in enumerate(cameras):
        for u, v in pixels[a]:
            z = float(frames[a].depth_m[v, u])
            k = camera.intrinsics
            point = camera.world_from_camera @ [(u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z, 1]
            for b, other in enumerate(cameras):
                if b == a:
                    continue
                x, y, d, _ = other.camera_from_world @ point
                k = other.intrinsics
                if d <= 0.02:
                    continue
                at_u, at_v = k.fx * x / d + k.cx, k.fy * y / d + k.cy
                if not (1 <= at_u <= other.width - 2 and 1 <= at_v <= other.height - 2):
                    continue
                column, row = round(at_u), round(at_v)
                seen = frames[b].depth_m[row - 1 : row + 2, column - 1 : column + 2]
                wide = wide_m(z, d) + 2 * margin.bias_m
                if seen.min() > d + wide:
                    counts[0, a, b] += 1
                elif seen.max() < d - wide:
                    counts[2, a, b] += 1
                else:
                    counts[1, a, b] += 1
    return counts
