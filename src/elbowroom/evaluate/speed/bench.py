"""How fast, on this computer: carve and whole cycles in the simulated room, and OctoMap on the same images."""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.evaluate.due import FULL_ROOM, Due, where
from elbowroom.geometry import DepthCamera
from elbowroom.geometry.parallel import default_threads
from elbowroom.sensing import DepthFrame
from elbowroom.simulate import InterventionRoom, render, wall_cameras

MOMENTS_S = (3.0, 11.0)


@dataclass(frozen=True, slots=True)
class BenchCase:
    """One process of the benchmark.

    Args:
        voxel_size_m: edge of a voxel [m].
        detail: of the carve.
        noise: whether the cameras have noise and margins.
        rounds: how many times each part is measured.
    """

    voxel_size_m: float
    detail: str
    noise: bool
    rounds: int


DUE = (
    *(
        Due("median_ms", "≤", ms, where(**FULL_ROOM, case=case, voxel_size_m=edge, detail=detail))
        for case, edge, detail, ms in (
            ("carve", 0.05, "footprint", 25.0),
            ("carve", 0.02, "footprint", 130.0),
            ("cycle", 0.05, "footprint", 45.0),
            ("cycle", 0.02, "footprint", 180.0),
            ("cycle", 0.05, "pixel", 140.0),
            ("cycle", 0.02, "pixel", 480.0),
        )
    ),
    Due("peak_rss_mb", "≤", 600.0, where(**FULL_ROOM, voxel_size_m=0.02)),
    Due("times_slower_than_carve", "≥", 500.0),
)
"""On two cores."""
CASES = (
    BenchCase(0.05, "footprint", False, 60),
    BenchCase(0.02, "footprint", False, 40),
    BenchCase(0.05, "pixel", False, 40),
    BenchCase(0.02, "pixel", False, 25),
    BenchCase(0.02, "pixel", True, 15),
)


def bench_rows(
    cases: Sequence[BenchCase] = CASES,
    *,
    cameras: int = 21,
    size: str = "vga",
    threads: int | None = None,
    octomap: bool = True,
) -> Iterator[dict[str, Any]]:
    """Measures one case after the other, each in a process of its own.

    Args:
        cases: what to measure.
        cameras, size: of the simulated cameras.
        threads: None: all cores.
        octomap: also insert the same images into an OctoMap at 5 cm, if pyoctomap is there.

    Yields:
        Rows of case, voxel_size_m, cameras, width, height, detail, noise, threads, rounds, median_ms, p99_ms, max_ms,
        peak_rss_mb, ratio (median over that of a fixed reference kernel in the same process).

    Raises:
        InputError: a case failed; its message is the child's last line.
    """
    with tempfile.TemporaryDirectory() as folder:
        for noise in sorted({case.noise for case in cases}):
            save_scenes(Path(folder) / f"scene_{noise}.npz", cameras, size, noise)
        carve_ms = None
        for case in cases:
            for row in _in_own_process(Path(folder) / f"scene_{case.noise}.npz", case, threads):
                if row["case"] == "carve" and case.voxel_size_m == 0.05 and case.detail == "footprint":
                    carve_ms = row["median_ms"]
                yield row
        if octomap:
            yield from _octomap_row(cameras, size, carve_ms)


def save_scenes(path: Path, cameras: int, size: str, noise: bool) -> None:
    """Renders two moments of the room and writes them for the cases' processes.

    Args:
        path: of the file.
        cameras, size: along the walls, and of their images.
        noise: whether they have any.
    """
    from elbowroom.sensing import NOISE_PRESETS

    room = InterventionRoom()
    watching = wall_cameras(cameras, size=size, noise=NOISE_PRESETS["tof"] if noise else None)
    moments = [room.at(time_s) for time_s in MOMENTS_S]
    k = watching[0].intrinsics
    np.savez(
        path,
        poses=np.array([camera.world_from_camera for camera in watching]),
        lens=np.array([k.fx, k.fy, k.cx, k.cy]),
        depths=np.array([[frame.depth_m for frame in render(watching, moment)] for moment in moments]),
        joints=np.array([[moment.joints[name] for name in room.machine.joint_names] for moment in moments]),
    )


def _in_own_process(scene_file: Path, case: BenchCase, threads: int | None) -> list[dict[str, Any]]:
    given = {
        "scene_file": str(scene_file),
        "voxel_size_m": case.voxel_size_m,
        "detail": case.detail,
        "noise": case.noise,
        "threads": threads or default_threads(),
        "rounds": case.rounds,
    }
    done = subprocess.run(
        [sys.executable, "-m", "elbowroom.evaluate.speed.bench_case", json.dumps(given)],
        capture_output=True,
        text=True,
    )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise InputError(f"bench: case {case} ended with {done.returncode}: {last}")
    rows: list[dict[str, Any]] = json.loads(done.stdout)
    return rows


def _octomap_row(cameras: int, size: str, carve_ms: float | None) -> Iterator[dict[str, Any]]:
    try:
        import pyoctomap
    except ImportError:
        return
    watching = wall_cameras(cameras, size=size)
    frames = render(watching, InterventionRoom().at(MOMENTS_S[0]), noise=False)
    tree = pyoctomap.OcTree(0.05)
    clouds = [_cloud(camera, frame) for camera, frame in zip(watching, frames, strict=True)]
    start = time.perf_counter()
    for camera, cloud in zip(watching, clouds, strict=True):
        tree.insertPointCloud(cloud, np.array(camera.centre_in_world))
    spent = (time.perf_counter() - start) * 1e3
    yield {
        "case": "octomap",
        "voxel_size_m": 0.05,
        "cameras": len(watching),
        "width": watching[0].width,
        "height": watching[0].height,
        "detail": "OctoMap, default probabilities",
        "noise": False,
        "threads": 1,
        "rounds": 1,
        "median_ms": spent,
        "p99_ms": spent,
        "max_ms": spent,
        "peak_rss_mb": None,
        "ratio": None,
        "times_slower_than_carve": None if carve_ms is None else spent / carve_ms,
    }


def _cloud(camera: DepthCamera, frame: DepthFrame) -> np.ndarray:
    points = camera.points_in_world(frame.depth_m)[frame.depth_m > 0]
    return np.ascontiguousarray(points)
