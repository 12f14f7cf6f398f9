"""Parts of a pass in a process of its own, as often as it is asked: a script, of whichever package it finds.

    python -P parts_case.py SCENE_FILE VOXEL_M THREADS

Says `ready`; then for each line on its standard input, one look at each part: milliseconds by the wall clock and of
processor time, as JSON.
"""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from elbowroom.evaluate.speed.bench_case import BRAKING_TIME_S, SPEEDS, Scene
from elbowroom.geometry import VoxelGrid, parallel
from elbowroom.machine import Machine, body_words, explain_frames
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.monitor import Cycle
from elbowroom.motion import Braking, Trajectory, check_motions, check_path, joint_motions, link_distances
from elbowroom.reconstruct import Terms
from elbowroom.sensing import NOISE_PRESETS, Snapshot

LOOK_M = 1.5
"""How far distances are asked for [m]."""
POINTS, PATH_S = 200, 4.0
"""Of a path, and how long it takes [s]."""


def parts_of(scene: Scene, voxel_size_m: float) -> dict[str, Callable[[int], object]]:
    """What is timed, by name; each takes the number of a moment.

    Args:
        scene: cameras, images and joints of some moments.
        voxel_size_m: edge of a voxel [m].
    """
    machine = ceiling_c_arm()
    grid = VoxelGrid.covering((-2.0, -2.0, 0.0), (2.0, 2.0, 2.5), voxel_size_m)
    motions = joint_motions(machine, SPEEDS, BRAKING_TIME_S)
    cycle = Cycle(grid, scene.cameras, machine, motions, Terms(detail="pixel"), keeps_images=True)
    joints = [dict(zip(machine.joint_names, row, strict=True)) for row in scene.joints]
    depths = [[frame.depth_m for frame in moment] for moment in scene.moments]
    spaces = [cycle.run(Snapshot.taken(scene.moments[m], joints[m], m)).space for m in range(len(joints))]
    paths = [_path(machine, one) for one in joints]
    brakes = Braking(SPEEDS, dict.fromkeys(SPEEDS, BRAKING_TIME_S))

    def seen(m: int) -> Any:
        space = spaces[m]
        assert space is not None
        return space

    return {
        "explain": lambda m: explain_frames(
            machine, scene.cameras, depths[m], [joints[m]] * len(scene.cameras), grid=grid
        ),
        "body out": lambda m: body_words(machine, joints[m], grid, 0.75 * voxel_size_m),
        "eight motions": lambda m: check_motions(seen(m), machine, joints[m], motions),
        "distances": lambda m: link_distances(seen(m), machine, joints[m], LOOK_M),
        "path of 200 points": lambda m: check_path(seen(m), machine, paths[m], joints[m], brakes),
    }


def _path(machine: Machine, joints: dict[str, float]) -> Trajectory:
    """All joints go by sines from where they are, at a fifth of full speed at most."""
    times_s = np.linspace(0.0, PATH_S, POINTS)
    turn = np.sin(np.pi * times_s / PATH_S) * PATH_S / np.pi
    way = [
        joints[name] - 0.2 * SPEEDS[name] * turn * np.sign(joints[name] or 1.0)
        for name in machine.joint_names
    ]
    return Trajectory(machine.joint_names, times_s, np.array(way).T)


def main(scene_file: str, voxel_m: str, threads: str) -> None:
    """As the module says."""
    scene = Scene.load(Path(scene_file), NOISE_PRESETS["tof"])
    with parallel.threads(int(threads)):
        parts = parts_of(scene, float(voxel_m))
        for part in parts.values():
            part(0)
        print("ready", flush=True)
        for n, _ in enumerate(sys.stdin):
            spent = {}
            for name, part in parts.items():
                begun, begun_cpu = time.perf_counter(), time.process_time()
                part(n % len(scene.moments))
                spent[name] = 1e3 * (time.perf_counter() - begun), 1e3 * (time.process_time() - begun_cpu)
            print(json.dumps(spent), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
