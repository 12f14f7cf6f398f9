"""Other systems on the same images as carve, in the same run: the ratio says more than the time."""

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from elbowroom.evaluate.due import Due
from elbowroom.geometry import DepthCamera, VoxelGrid
from elbowroom.reconstruct import carve
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import InterventionRoom, render, wall_cameras

VOXEL_M = 0.05
"""At which all of them are measured [m]."""
MOMENT_S = 3.0
ROUNDS = 7
"""Of what takes less than a second."""
DUE = (Due("times_as_long", "≥", 1500.0, lambda row: row.get("case") == "OctoMap"),)
Watching = Sequence[DepthCamera]
Frames = Sequence[DepthFrame]


def other_rows(cameras: int = 21, width: int = 640, height: int = 480) -> Iterator[dict[str, Any]]:
    """Carve by footprint, then the other systems that are installed.

    Args:
        cameras, width, height: how many, and their images [px].

    Yields:
        Rows of question ("others"), case, median_ms, rounds, times_as_long (as carve by footprint).
    """
    watching = wall_cameras(cameras, width=width, height=height)
    frames = render(watching, InterventionRoom().at(MOMENT_S), noise=False)
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), VOXEL_M)
    ours = [
        ("carve, footprint", lambda: carve(grid, watching, frames, detail="footprint")),
        ("carve, pixel", lambda: carve(grid, watching, frames, detail="pixel")),
        ("test of centres, compiled", lambda: carve(grid, watching, frames, detail="point")),
        ("test of centres, NumPy", lambda: _centres(grid, watching, frames)),
    ]
    least = None
    for case, work in ours:
        work()
        spent = _median_ms(work, ROUNDS)
        least = spent if least is None else least
        yield _row(case, spent, ROUNDS, least)
    assert least is not None
    for case, other in (("OctoMap", _octomap), ("Open3D VoxelBlockGrid, no free space", _open3d)):
        once = other(watching, frames)
        if once is not None:
            rounds = 1 if case == "OctoMap" else ROUNDS
            yield _row(case, _median_ms(once, rounds), rounds, least)


def _row(case: str, spent: float, rounds: int, least: float) -> dict[str, Any]:
    said = {"question": "others", "case": case, "voxel_size_m": VOXEL_M, "rounds": rounds}
    return {**said, "median_ms": spent, "times_as_long": spent / least}


def _median_ms(work: Callable[[], object], rounds: int) -> float:
    spent = []
    for _ in range(rounds):
        begun = time.perf_counter()
        work()
        spent.append((time.perf_counter() - begun) * 1e3)
    return float(np.median(spent))


def _centres(grid: VoxelGrid, cameras: Watching, frames: Frames) -> np.ndarray:
    """Which centres of voxels any camera sees past, as one writes it in NumPy."""
    corner = np.asarray(grid.lower_m) + grid.voxel_size_m / 2
    centres = corner + np.moveaxis(np.indices(grid.shape), 0, -1).reshape(-1, 3) * grid.voxel_size_m
    free = np.zeros(len(centres), dtype=bool)
    for camera, frame in zip(cameras, frames, strict=True):
        k = camera.intrinsics
        x, y, z = camera.camera_from_world[:3, :3] @ centres.T + camera.camera_from_world[:3, 3:]
        ahead = np.where(z > 0.01, z, 1.0)
        u, v = np.rint(k.fx * x / ahead + k.cx), np.rint(k.fy * y / ahead + k.cy)
        seen = (z > 0.01) & (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height)
        at = np.flatnonzero(seen)
        free[at] |= frame.depth_m[v[at].astype(int), u[at].astype(int)] > z[at]
    return free


def _octomap(cameras: Watching, frames: Frames) -> Callable[[], object] | None:
    try:
        import pyoctomap
    except ImportError:
        return None
    clouds = [
        np.ascontiguousarray(camera.points_in_world(frame.depth_m)[frame.depth_m > 0])
        for camera, frame in zip(cameras, frames, strict=True)
    ]
    tree = pyoctomap.OcTree(VOXEL_M)

    def once() -> None:
        for camera, cloud in zip(cameras, clouds, strict=True):
            tree.insertPointCloud(cloud, np.array(camera.centre_in_world))

    return once


def _open3d(cameras: Watching, frames: Frames) -> Callable[[], object] | None:
    try:
        import open3d.core as o3c
        from open3d.t.geometry import Image, VoxelBlockGrid
    except (ImportError, OSError):  # a wheel whose libraries are not there
        return None
    k = cameras[0].intrinsics
    lens = o3c.Tensor(np.array([[k.fx, 0, k.cx], [0, k.fy, k.cy], [0, 0, 1.0]]))
    poses = [o3c.Tensor(camera.camera_from_world) for camera in cameras]
    images = [Image(o3c.Tensor(np.ascontiguousarray(frame.depth_m))) for frame in frames]

    def once() -> None:
        volume = VoxelBlockGrid(("tsdf", "weight"), (o3c.float32, o3c.float32), ((1), (1)), VOXEL_M, 16, 4000)
        for pose, image in zip(poses, images, strict=True):
            blocks = volume.compute_unique_block_coordinates(image, lens, pose, 1.0, 6.0)
            volume.integrate(blocks, image, lens, pose, 1.0, 6.0)

    return once
