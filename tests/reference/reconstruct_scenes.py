"""Random rooms of balls and boxes, cameras that look into them, images and truth by closed formulas."""

from dataclasses import dataclass, field

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, bits
from elbowroom.sensing import DepthFrame

SIDES = (5, 8, 9, 16, 17, 18, 21, 24)
"""Of grids: some are multiples of 4 or 16, some are not."""


@dataclass
class Scene:
    """Balls (x, y, z, radius) and boxes (lower, upper), in a room whose walls are a box; no walls: no return."""

    balls: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    boxes: np.ndarray = field(default_factory=lambda: np.zeros((0, 6)))
    walls: tuple | None = ((-6, -6, -6), (6, 6, 6))


def looking_at(eye, target, roll=0.0):
    """Pose world_from_camera of a camera at `eye` that looks at `target`, turned by `roll` about its axis."""
    forward = np.asarray(target, dtype=float) - eye
    forward /= np.linalg.norm(forward)
    helper = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = np.cross(forward, helper)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    pose = np.eye(4)
    pose[:3, 0] = np.cos(roll) * right + np.sin(roll) * down
    pose[:3, 1] = -np.sin(roll) * right + np.cos(roll) * down
    pose[:3, 2] = forward
    pose[:3, 3] = eye
    return pose


def camera_at(name, eye, target, roll=0.0, size=(48, 36), focal=40.0, kind="planar", **more):
    """A camera by where it is and where it looks."""
    lens = Intrinsics(fx=focal, fy=focal * 1.02, cx=(size[0] - 1) / 2 + 0.3, cy=(size[1] - 1) / 2 - 0.2)
    return DepthCamera(name, size[0], size[1], looking_at(eye, target, roll), lens, depth_kind=kind, **more)


def rays_of(camera):
    """Directions of all pixels, shape (height, width, 3), world frame, as long as planar depth 1 is."""
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    in_camera = np.stack(np.broadcast_arrays(x[None, :], y[:, None], 1.0), axis=-1)
    return in_camera @ camera.world_from_camera[:3, :3].T


def depth_of(camera, scene):
    """The exact depth image, float32; 0 where a ray meets nothing."""
    rays, eye = rays_of(camera), camera.centre_in_world
    depth = np.full(rays.shape[:2], np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        for *centre, radius in scene.balls:
            to_centre = np.asarray(centre) - eye
            a = (rays * rays).sum(axis=-1)
            b = rays @ to_centre
            under = b * b - a * (to_centre @ to_centre - radius * radius)
            near = (b - np.sqrt(under)) / a
            depth = np.where((under >= 0) & (near > 0), np.minimum(depth, near), depth)
        for box in scene.boxes:
            enter, leave = _through_box(eye, rays, box[:3], box[3:])
            depth = np.where((enter <= leave) & (enter > 0), np.minimum(depth, enter), depth)
        if scene.walls is not None:
            depth = np.minimum(depth, _through_box(eye, rays, *map(np.asarray, scene.walls))[1])
    if camera.depth_kind == "radial":
        depth = depth * np.linalg.norm(rays, axis=-1)
    return np.where(np.isfinite(depth), depth, 0).astype(np.float32)


def _through_box(eye, rays, lower, upper):
    one, other = (lower - eye) / rays, (upper - eye) / rays
    return np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)


def frame_of(camera, scene, stamp_ns=0):
    """The exact frame of a camera."""
    return DepthFrame(camera.name, stamp_ns, depth_of(camera, scene))


def corners_of(grid):
    """Least corners of all voxels, shape of the grid + (3,)."""
    return grid.lower_m + np.moveaxis(np.indices(grid.shape), 0, -1) * grid.voxel_size_m


def touched(grid, scene):
    """The voxels whose open box meets a solid, shape of the grid."""
    lower = corners_of(grid)
    upper = lower + grid.voxel_size_m
    hit = np.zeros(grid.shape, dtype=bool)
    for *centre, radius in scene.balls:
        hit |= np.linalg.norm(np.clip(centre, lower, upper) - centre, axis=-1) < radius
    for box in scene.boxes:
        hit |= ((lower < box[3:]) & (upper > box[:3])).all(axis=-1)
    return hit


def random_grid(rng):
    """A grid of 5 to 24 voxels a side."""
    shape = tuple(int(n) for n in rng.choice(SIDES, 3))
    return VoxelGrid(tuple(rng.uniform(-1, 1, 3)), shape, float(rng.uniform(0.04, 0.07)))


def random_cameras(rng, grid, count, **more):
    """Cameras around and sometimes inside a grid that look at some point of it."""
    middle, span = (grid.lower_m + grid.upper_m) / 2, (grid.upper_m - grid.lower_m).max()
    cameras = []
    for n in range(count):
        away = rng.normal(size=3)
        eye = middle + away / np.linalg.norm(away) * span * rng.choice((0.4, 0.8, 1.2, 1.8))
        width, height = ((48, 36), (63, 41), (96, 72))[rng.integers(3)]
        given = {
            "size": (width, height),
            "kind": ("planar", "radial")[rng.integers(2)],
            "focal": float(rng.uniform(0.5, 1.1) * width),
        }
        cameras.append(
            camera_at(
                f"c{n}",
                eye,
                grid.lower_m + rng.uniform(0.1, 0.9, 3) * (grid.upper_m - grid.lower_m),
                roll=rng.uniform(-3, 3),
                **(given | more),
            )
        )
    return cameras


def random_scene(rng, grid, balls=3, boxes=2, cameras=()):
    """A few balls and boxes in a grid; none of them holds a camera."""
    low, span = grid.lower_m, grid.upper_m - grid.lower_m
    scene = Scene()
    round_ones = [[*(low + rng.random(3) * span), rng.uniform(0.05, 0.25) * span.min()] for _ in range(balls)]
    corners = [low + rng.random(3) * span for _ in range(boxes)]
    square_ones = [[*corner, *(corner + rng.uniform(0.05, 0.4, 3) * span.min())] for corner in corners]
    eyes = [camera.centre_in_world for camera in cameras]
    scene.balls = np.array(
        [b for b in round_ones if all(np.linalg.norm(eye - b[:3]) > b[3] for eye in eyes)]
    ).reshape(-1, 4)
    scene.boxes = np.array(
        [b for b in square_ones if not any(((eye > b[:3]) & (eye < b[3:])).all() for eye in eyes)]
    ).reshape(-1, 6)
    if rng.random() < 0.3:
        scene.walls = None
    return scene


def random_room(seed, cameras=None, **more):
    """A grid, cameras that look into it, a scene, and the exact frames, by one number."""
    rng = np.random.default_rng(seed)
    grid = random_grid(rng)
    group = random_cameras(rng, grid, int(rng.integers(1, 7)) if cameras is None else cameras, **more)
    scene = random_scene(rng, grid, cameras=group)
    return rng, grid, group, scene, [frame_of(camera, scene) for camera in group]


def planes_of(evidence):
    """All planes of evidence as bool arrays of the grid's shape, stacked."""
    return np.stack([bits.unpack(plane, evidence.grid) for plane in evidence.planes])
