"""One case of `elbowroom bench --all` in a process of its own: `python -m` with a JSON argument."""

import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.evaluate.speed.bench_case import BRAKING_TIME_S, SPEEDS, Scene, summary
from elbowroom.evaluate.speed.outliers import Watch, cause_of_worst
from elbowroom.evaluate.speed.questions import Asked
from elbowroom.files.peak_memory import peak_memory_mb
from elbowroom.garbage import uncollected, what_is_here_stays
from elbowroom.geometry import VoxelGrid, parallel
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.monitor import Cycle
from elbowroom.motion import joint_motions
from elbowroom.reconstruct import Terms, carve
from elbowroom.sensing import NOISE_PRESETS, Snapshot

Pass = Callable[[int], Mapping[str, float]]
"""One pass by its number; times of its stages [ms]."""


def run_asked(scene_file: Path, asked: Asked) -> dict[str, Any]:
    """Measures one case; garbage waits for the end of a pass, as it does in the monitor.

    Args:
        scene_file: as `asked_scene.save_scene` wrote it.
        asked: the case.
    """
    scene = Scene.load(scene_file, NOISE_PRESETS["tof"] if asked.noise else None)
    once, more = _carve(scene, asked) if asked.part == "carve" else _cycle(scene, asked)
    with parallel.threads(asked.threads):
        for n in range(2):
            once(n)
        spent = []
        with what_is_here_stays():
            for n in range(asked.rounds):
                with uncollected(), Watch() as watch:
                    stage_ms = once(n)
                spent.append(watch.spent(stage_ms))
    names = list(spent[-1].stage_ms)
    stages = {name: float(np.median([one.stage_ms[name] for one in spent])) for name in names}
    return {
        **{key: getattr(asked, key) for key in Asked.__slots__},
        **more,
        **summary([one.ms for one in spent]),
        "cause": cause_of_worst(spent),
        "stages_ms": stages,
        "peak_rss_mb": peak_memory_mb(),
    }


def _cycle(scene: Scene, asked: Asked) -> tuple[Pass, dict[str, Any]]:
    machine = ceiling_c_arm()
    positions = [dict(zip(machine.joint_names, row, strict=True)) for row in scene.joints]
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), asked.voxel_size_m)
    motions = joint_motions(machine, SPEEDS, BRAKING_TIME_S)
    cycle = Cycle(grid, scene.cameras, machine, motions, Terms(detail=asked.detail))

    def once(n: int) -> Mapping[str, float]:
        m = n % len(scene.moments)
        result = cycle.run(Snapshot.taken(scene.moments[m], positions[m], m))
        if result.fault is not None:
            raise RuntimeError(result.fault)
        return result.stage_ms

    return once, {}


def _carve(scene: Scene, asked: Asked) -> tuple[Pass, dict[str, Any]]:
    half = asked.half_m
    grid = VoxelGrid.covering((-half, -half, -half), (half, half, half), asked.voxel_size_m)
    evidence = carve(grid, scene.cameras, scene.moments[0], detail=asked.detail)
    surface = int(np.unpackbits(evidence.surface.view(np.uint8)).sum())

    def once(_: int) -> Mapping[str, float]:
        carve(grid, scene.cameras, scene.moments[0], detail=asked.detail)
        return {}

    return once, {"voxels": int(np.prod(grid.shape)), "surface_voxels": surface}


if __name__ == "__main__":
    given = json.loads(sys.argv[1])
    print(json.dumps(run_asked(Path(given.pop("scene_file")), Asked(**given))))
