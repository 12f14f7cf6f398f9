"""Cameras on two computers: each turns its own images into evidence, one merges and decides. The bits are the same.

    python examples/07_two_computers.py

What travels is a few bits a voxel, not images.
"""

import numpy as np

import elbowroom as er
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, render, wall_cameras

grid = er.VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.05)
cameras = wall_cameras(8, height_m=(2.4, 0.4), width=320, height=240, noise=NOISE_PRESETS["tof"])
room = InterventionRoom()
frames = render(cameras, room.at(time_s=5.0))

left = er.carve(grid, cameras[:4], frames[:4])
right = er.carve(grid, cameras[4:], frames[4:])
images_mb = sum(frame.depth_m.nbytes for frame in frames[:4]) / 1e6
print(f"images of one side: {images_mb:.1f} MB; evidence of one side: {left.planes.nbytes / 1e6:.1f} MB")

merged = er.resolve(er.merge([left, right]), cameras)
alone = er.resolve(er.carve(grid, cameras, frames), cameras)
assert np.array_equal(merged.free, alone.free)
print(f"merged in any order or computed at once: {100 * merged.free.mean():.1f} % free, the same voxels")

# a computer that is lost: its cameras dispute all that they look at, and nothing becomes free
lost = er.resolve(left, cameras)
print(
    f"without the right side: {100 * lost.free.mean():.1f} % free, {(lost.free & ~merged.free).sum()} voxels more"
)
