"""One benchmark case in a process of its own, so that its peak memory is its own: `python -m` with a JSON argument."""

import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from elbowroom.choices import Detail
from elbowroom.evaluate.rooms.room import cameras_row
from elbowroom.evaluate.speed.kernels.reference import reference
from elbowroom.files.peak_memory import peak_memory_mb
from elbowroom.garbage import uncollected, what_is_here_stays
from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid, parallel
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.monitor import Cycle
from elbowroom.motion import joint_motions
from elbowroom.reconstruct import Terms, carve
from elbowroom.sensing import NOISE_PRESETS, DepthFrame, NoiseModel, Snapshot

SPEEDS = {"long": 0.15, "larm": np.radians(12), "propeller": np.radians(25), "carc": np.radians(25)}
"""Full speeds of the ceiling C-arm [m/s or rad/s]."""
BRAKING_TIME_S = 0.5


def _times(work: Callable[[int], object], rounds: int, beside: list[float]) -> list[float]:
    """Milliseconds of each round, each beside one of the reference kernel; garbage waits as it does in the monitor."""
    table = np.linspace(0, 1, 1 << 18, dtype=np.float32)
    reference(table)
    work(0)
    work(1)
    spent = []
    with what_is_here_stays():
        for n in range(rounds):
            start = time.perf_counter()
            reference(table)
            middle = time.perf_counter()
            with uncollected():
                work(n)
                spent.append((time.perf_counter() - middle) * 1e3)
            beside.append((middle - start) * 1e3)
    return spent


def run_case(
    scene_file: Path, voxel_size_m: float, detail: Detail, noise: bool, threads: int, rounds: int
) -> list[dict[str, Any]]:
    """Carve alone in the bare room, then whole cycles with machine and motions, then the cycle's stages.

    Args:
        scene_file: .npz of poses, lens, depths and joints (`bench.save_scenes`).
        voxel_size_m, detail: as of `Cycle`.
        threads: over so many the work is spread.
        noise: whether cameras have a noise model, hence margins and the filter of flying pixels.
        rounds: how many times each is measured.
    """
    scene = Scene.load(scene_file, NOISE_PRESETS["tof"] if noise else None)
    machine, moments = ceiling_c_arm(), scene.moments
    positions = [dict(zip(machine.joint_names, row, strict=True)) for row in scene.joints]
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), voxel_size_m)
    motions = joint_motions(machine, SPEEDS, BRAKING_TIME_S)
    cycle = Cycle(grid, scene.cameras, machine, motions, Terms(detail=detail))
    stages: list[Mapping[str, float]] = []

    def pass_once(n: int) -> None:
        m = n % len(moments)
        result = cycle.run(Snapshot.taken(moments[m], positions[m], m))
        if result.fault is not None:
            raise RuntimeError(result.fault)
        stages.append(result.stage_ms)

    def carve_once(n: int) -> None:
        carve(grid, scene.cameras, moments[n % len(moments)], detail=detail)

    beside: list[float] = []
    with parallel.threads(threads):
        measured = {"carve": _times(carve_once, rounds, beside), "cycle": _times(pass_once, rounds, beside)}
    measured |= {f"cycle/{name}": [stage[name] for stage in stages[2:]] for name in stages[-1]}
    said = {"voxel_size_m": voxel_size_m, **cameras_row(scene.cameras), "detail": detail, "noise": noise}
    said |= {"threads": threads, "rounds": rounds}
    peak = {"peak_rss_mb": peak_memory_mb()}
    against = float(np.median(beside))
    return [
        {"case": case, **said, **summary(spent), **peak, "ratio": float(np.median(spent)) / against}
        for case, spent in measured.items()
    ]


class Scene(NamedTuple):
    """Cameras, and the frames and joint positions of some moments."""

    cameras: list[DepthCamera]
    moments: list[list[DepthFrame]]
    joints: list[list[float]]

    @classmethod
    def load(cls, path: Path, noise: NoiseModel | None) -> "Scene":
        """As `bench.save_scenes` wrote it."""
        with np.load(path, allow_pickle=False) as scenes:
            poses, lens, depths, joints = (scenes[name] for name in ("poses", "lens", "depths", "joints"))
        height, width = depths.shape[2:]
        cameras = [
            DepthCamera(f"cam{n:02d}", width, height, pose, Intrinsics(*lens), noise=noise)
            for n, pose in enumerate(poses)
        ]
        moments = [
            [DepthFrame(camera.name, m, image) for camera, image in zip(cameras, images, strict=True)]
            for m, images in enumerate(depths)
        ]
        return cls(cameras, moments, joints.tolist())


def summary(spent: Sequence[float]) -> dict[str, float]:
    """Median, 99th percentile and the most of times [ms]."""
    return {
        "median_ms": float(np.median(spent)),
        "p99_ms": float(np.percentile(spent, 99)),
        "max_ms": float(np.max(spent)),
    }


if __name__ == "__main__":
    given = json.loads(sys.argv[1])
    given["scene_file"] = Path(given["scene_file"])
    print(json.dumps(run_case(**given)))
