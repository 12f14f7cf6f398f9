"""Carve and sweep on a GPU beside the processor: the same bits, and how long each takes.

    pip install -e '.[cuda]'
    python benchmarks/gpu.py --json benchmarks/results/gpu.json     # on a computer with an NVIDIA GPU
    python benchmarks/gpu.py --compile                              # without one: what the code generator makes of it

`--compile` counts multiplications and additions that were fused into one rounding; there must be none.
"""

import argparse
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numba import typeof

from elbowroom.evaluate.rooms.scene import room_grid, room_motions
from elbowroom.files.json_rows import write_json
from elbowroom.gpu import carve_on_gpu, find_block_on_gpu
from elbowroom.gpu.device import cuda
from elbowroom.gpu.kernels.threads import carve_words, sweep_samples
from elbowroom.motion.course import way_of
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import cluster_speeds, find_block, volume_of
from elbowroom.reconstruct import carve, reconstruct
from elbowroom.simulate import InterventionRoom, render, wall_cameras

TURNS = 10


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    """The last answer, and the median time of `TURNS` calls after a first one [ms]."""
    answer, times = call(), []
    for _ in range(TURNS):
        begun = time.perf_counter()
        answer = call()
        times.append(1e3 * (time.perf_counter() - begun))
    return answer, float(np.median(times))


def rows(voxel_size_m: float) -> list[dict[str, Any]]:
    """The simulated room, 21 cameras of 640 x 480, and its eight motions: here and there."""
    room, grid = InterventionRoom(), room_grid(voxel_size_m)
    moment = room.at(3.0)
    views = wall_cameras(21, (2.4, 0.4), size="vga")
    frames = render(views, moment)
    here, here_ms = timed(lambda: carve(grid, views, frames))
    there, there_ms = timed(lambda: carve_on_gpu(grid, views, frames))
    found = [row("carve", voxel_size_m, np.array_equal(here.planes, there.planes), here_ms, there_ms)]
    machine, joints = room.machine, moment.joints
    space = reconstruct(grid, views, frames, machine, joints, looks=False)
    skin, volume, start = skin_of(machine, voxel_size_m), volume_of(space), machine.positions(joints)
    placed = machine.world_from_link_array(start[None])[0]
    for motion in room_motions(machine):
        way = way_of(machine, start, motion)
        speeds = cluster_speeds(machine, skin, placed, way)
        asked = machine, skin, speeds, way, volume
        here, here_ms = timed(lambda asked=asked: find_block(*asked))
        there, there_ms = timed(lambda asked=asked: find_block_on_gpu(*asked))
        same = (here and here[:3]) == (there and there[:3])
        found.append(row(f"sweep {motion.name}", voxel_size_m, same, here_ms, there_ms))
    return found


def row(what: str, voxel_size_m: float, same: bool, here_ms: float, there_ms: float) -> dict[str, Any]:
    """One comparison; times hold all copies to the device and back."""
    return {
        "kind": "gpu",
        "what": what,
        "voxel_size_m": voxel_size_m,
        "same_bits": bool(same),
        "processor_ms": here_ms,
        "gpu_ms": there_ms,
    }


def fused() -> int:
    """How many multiplications and additions the code generator fuses in both kernels, for a device of today."""
    room, grid = InterventionRoom(), room_grid(0.1)
    moment = room.at(3.0)
    views = wall_cameras(3, size="qqvga")
    jobs = jobs_of(room, grid, views, render(views, moment), moment.joints)
    count = 0
    for thread, job_type in jobs:
        code = code_of(thread, job_type)
        here = len(re.findall(r"\bfma\.", code)) + len(re.findall(r"\b(?:mul|add|sub)\.f(?:32|64)\b", code))
        print(f"{thread.__name__}: {len(code.splitlines())} lines, fused or free to be fused {here}")
        count += here
    return count


def jobs_of(room: Any, grid: Any, views: Any, frames: Any, joints: Any) -> list[tuple[Any, Any]]:
    """What a carve and a sweep run on the device, and the type of what they hand to it."""
    import elbowroom.gpu.carve as on_gpu
    import elbowroom.gpu.sweep as swept_on_gpu

    jobs: list[tuple[Any, Any]] = []
    on_gpu.launch = swept_on_gpu.launch = lambda thread, _, job: jobs.append((thread, typeof(job)))
    carve_on_gpu(grid, views, frames)
    machine, start = room.machine, room.machine.positions(joints)
    space = reconstruct(grid, views, frames, machine, joints, looks=False)
    skin, motion = skin_of(machine, grid.voxel_size_m), room_motions(machine)[0]
    way = way_of(machine, start, motion)
    speeds = cluster_speeds(machine, skin, machine.world_from_link_array(start[None])[0], way)
    find_block_on_gpu(machine, skin, speeds, way, volume_of(space))
    return [next(job for job in jobs if job[0] is thread) for thread in (carve_words, sweep_samples)]


def code_of(thread: Callable[..., None], job_type: Any) -> str:
    """The code for the device (PTX). No device is needed: that one of compute capability 9.0 is meant is said here."""
    from types import SimpleNamespace

    import numba.cuda.dispatcher as dispatcher

    dispatcher.get_current_device = lambda: SimpleNamespace(compute_capability=(9, 0))
    code, _ = cuda().compile_ptx(thread, (job_type,), cc=(9, 0))
    return str(code)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--compile", action="store_true", help="only look at what the code generator makes of it"
    )
    parser.add_argument("--json", type=Path, help="write the results")
    asked = parser.parse_args()
    if asked.compile:
        return 1 if fused() else 0
    found = []
    for voxel_size_m in (0.05, 0.02):
        for one in rows(voxel_size_m):
            print(one, flush=True)
            found.append(one)
    write_json(asked.json, found)
    return 0 if all(one["same_bits"] for one in found) else 1


if __name__ == "__main__":
    sys.exit(main())
