"""How often a voxel that a sharp or thin solid touches is declared free: what the promise on solids leaves out.

Each scene is one solid in an otherwise empty room, seen without noise and without margins: a box of 10 to 40 cm with
corners, turned at random, or a rod 60 cm long with round ends. The rod's diameter is given in pixel pitches at its
range, of the camera that sees it most coarsely.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from elbowroom.choices import Detail, Rule
from elbowroom.evaluate.rooms.lone_solids import Hang, LoneSolid, Rod, TurnedBox
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, looking_at
from elbowroom.reconstruct import reconstruct
from elbowroom.sensing import DepthFrame

GRID = VoxelGrid((-0.6, -0.6, -0.6), (24, 24, 24), 0.05)
WIDTH, HEIGHT, FOCAL_PX = 160, 120, 110.0
LENS = Intrinsics(fx=FOCAL_PX, fy=FOCAL_PX * 1.02, cx=(WIDTH - 1) / 2 + 0.3, cy=(HEIGHT - 1) / 2 - 0.2)
WALL_M = 6.0
"""How far the walls are from each camera [m]."""
GROUPS: tuple[tuple[int, Rule], ...] = ((1, "any"), (6, "three"), (21, "three"))
"""How many cameras, and by which rule."""
DETAILS: tuple[Detail, ...] = ("footprint", "pixel")
DIAMETERS_PX = (0.25, 0.5, 1.0, 2.0, 3.0)
SOLIDS: dict[str, Hang] = {"box with corners": TurnedBox.hung} | {
    f"rod of {px:g} pixel pitches": Rod.of_pixels(px) for px in DIAMETERS_PX
}
ROWS = len(SOLIDS) * len(GROUPS) * len(DETAILS)


def thin_solid_rows(scenes: int = 200) -> Iterator[dict[str, Any]]:
    """Every solid by every group of cameras and detail.

    Args:
        scenes: of each, told apart by their random numbers.

    Yields:
        Rows of solid, cameras, rule, detail, scenes, scenes_with_false_free, touched_voxels, false_free_voxels,
        occupied_pct.
    """
    for name, hang in SOLIDS.items():
        for count, rule in GROUPS:
            yield from _rows(name, hang, count, rule, scenes)


def _rows(name: str, hang: Hang, count: int, rule: Rule, scenes: int) -> Iterator[dict[str, Any]]:
    """A row for each detail: voxels touched, and voxels among them that were declared free."""
    touched_voxels, wrong = 0, np.zeros((scenes, len(DETAILS)), dtype=int)
    for seed in range(scenes):
        rng = np.random.default_rng(seed)
        cameras = cameras_around(rng, count)
        solid = hang(rng, cameras)
        frames = [frame_of(camera, solid) for camera in cameras]
        touched = solid.touched(GRID)
        touched_voxels += int(touched.sum())
        for n, detail in enumerate(DETAILS):
            free = reconstruct(GRID, cameras, frames, rule=rule, detail=detail, looks=False).free
            wrong[seed, n] = (free & touched).sum()
    for n, detail in enumerate(DETAILS):
        yield {
            "solid": name,
            "cameras": count,
            "rule": rule,
            "detail": detail,
            "width": WIDTH,
            "height": HEIGHT,
            "voxel_size_m": GRID.voxel_size_m,
            "scenes": scenes,
            "scenes_with_false_free": int((wrong[:, n] > 0).sum()),
            "touched_voxels": touched_voxels,
            "false_free_voxels": int(wrong[:, n].sum()),
            "occupied_pct": 100 * (1 - int(wrong[:, n].sum()) / touched_voxels),
        }


def cameras_around(rng: np.random.Generator, count: int) -> list[DepthCamera]:
    """Cameras 1.8 to 3.2 m from the middle, rolled at random, every second one with radial depth."""
    cameras = []
    for n in range(count):
        away = rng.normal(size=3)
        eye = away / np.linalg.norm(away) * rng.uniform(1.8, 3.2)
        target, roll = rng.uniform(-0.1, 0.1, 3), rng.uniform(-3, 3)
        steep = abs(target - eye)[2] >= 0.9 * np.linalg.norm(target - eye)
        pose = looking_at(tuple(eye), tuple(target), up=(1.0, 0.0, 0.0) if steep else (0.0, 0.0, 1.0))
        pose[:3, :3] = pose[:3, :3] @ _roll(roll)
        cameras.append(
            DepthCamera(f"c{n}", WIDTH, HEIGHT, pose, LENS, depth_kind="radial" if n % 2 else "planar")
        )
    return cameras


def _roll(angle: float) -> np.ndarray:
    """Rotation about a camera's own axis."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def frame_of(camera: DepthCamera, solid: LoneSolid) -> DepthFrame:
    """The exact image of one solid before walls."""
    x, y = camera.intrinsics.normalised(camera.width, camera.height)
    in_camera = np.stack(np.broadcast_arrays(x[None, :], y[:, None], 1.0), axis=-1)
    rays = in_camera @ camera.world_from_camera[:3, :3].T
    depth = np.minimum(solid.enter(camera.centre_in_world, rays), WALL_M)
    if camera.depth_kind == "radial":
        depth = depth * np.linalg.norm(rays, axis=-1)
    return DepthFrame(camera.name, 0, depth.astype(np.float32))
