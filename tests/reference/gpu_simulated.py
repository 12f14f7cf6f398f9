"""Carve and sweep by threads of numba's GPU simulator beside the processor's kernels: run with NUMBA_ENABLE_CUDASIM=1.

It prints how much was compared, a word and a number a line.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from elbowroom import carve
from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.geometry.noise import NoiseModel
from elbowroom.gpu import carve_on_gpu, find_block_on_gpu
from elbowroom.motion import Motion
from elbowroom.motion.course import way_of
from elbowroom.motion.skin import skin_of
from elbowroom.motion.sweep import cluster_speeds, find_block, volume_of
from elbowroom.reconstruct.carve import carve_aged
from elbowroom.reconstruct.free_space import FreeSpace
from reference import motion_machines as machines
from reference import reconstruct_scenes as scenes


def compare_carves(seed):
    """Voxels of a random room that are the same; cameras whose pixels fly, an image that is missing, ages, counts."""
    rng = np.random.default_rng(seed)
    grid = VoxelGrid(tuple(rng.uniform(-0.5, 0.5, 3)), (6, 5, 5), 0.1)
    more = {"noise": NoiseModel(0.003, 0.0, 0.002)} if seed % 2 else {}
    cameras = scenes.random_cameras(rng, grid, 4, **more)
    scene = scenes.random_scene(rng, grid, cameras=cameras)
    frames = [scenes.frame_of(camera, scene) for camera in cameras[: 4 - seed % 3 // 2]]
    margin = Margin(lateral_px=float(rng.choice((0, 0.5))))
    aged_m = {c.name: float(rng.choice((0, 0.05))) for c in cameras} if seed % 4 == 1 else {}
    complete = seed % 2 == 0
    if aged_m:
        here = carve_aged(grid, cameras, frames, aged_m, margin=margin, complete=complete)
    else:
        here = carve(grid, cameras, frames, margin=margin, complete=complete)
    there = carve_on_gpu(grid, cameras, frames, margin=margin, aged_m=aged_m, complete=complete)
    np.testing.assert_array_equal(there.planes, here.planes)
    if complete:
        np.testing.assert_array_equal(there.counts.through, here.counts.through)
        np.testing.assert_array_equal(there.counts.disputes, here.counts.disputes)
    return int(np.bitwise_count(here.planes).sum())


def compare_sweeps(arm):
    """Ways through walls, and through nothing, that end at the same block."""
    grid, ended = machines.room(0.1), 0
    wall = machines.touched_by_box(grid, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
    nearer = machines.touched_by_box(grid, (0.85, -1.0, 0.4), (1.2, 0.1, 0.8))
    ways = [(wall, "slide", 1, 0.3), (nearer, "slide", 1, 0.3), (machines.nothing_in(grid), "turn", -1, 0.2)]
    for blocked, joint, direction, reach in ways:
        space = FreeSpace.from_occupied(grid, blocked).without(arm, machines.HOME)
        volume, skin, start = volume_of(space), skin_of(arm, grid.voxel_size_m), arm.positions(machines.HOME)
        way = way_of(arm, start, Motion(joint, direction, 0.1, reach=reach))
        speeds = cluster_speeds(arm, skin, arm.world_from_link_array(start[None])[0], way)
        # one link: each thread is one of Python's
        speeds[skin.link != skin.link.max()] = 0
        here = find_block(arm, skin, speeds, way, volume)
        there = find_block_on_gpu(arm, skin, speeds, way, volume)
        assert (here is None) == (there is None)
        if here is not None:
            assert here[:3] == there[:3]
            np.testing.assert_array_equal(here.place_in_world, there.place_in_world)
            np.testing.assert_array_equal(np.sort(here.met), np.sort(there.met))
            ended += 1
    return ended


if __name__ == "__main__":
    print("bits", sum(compare_carves(seed) for seed in range(int(sys.argv[1]))))
    with TemporaryDirectory() as folder:
        print("blocks", compare_sweeps(machines.slider_and_arm(Path(folder))))
