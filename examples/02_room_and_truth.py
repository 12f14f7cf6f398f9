"""A whole room, and whether the answer is right: people and a C-arm, eight cameras with noise, and the exact truth.

    python examples/02_room_and_truth.py

In the simulated room it is known which voxels are touched by anything. None of them may be called free.
"""

import numpy as np

import elbowroom as er
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, render, true_occupancy, wall_cameras

room = InterventionRoom()
grid = er.VoxelGrid.covering((-2, -2, 0), (2, 2, 2.5), 0.05)
cameras = wall_cameras(8, height_m=(2.4, 0.4), width=320, height=240, noise=NOISE_PRESETS["kinect_v1"])

moment = room.at(time_s=7.0)  # doctor and nurses walk, the C-arm moves
frames = render(cameras, moment, seed=1)
space = er.reconstruct(grid, cameras, frames, machine=room.machine, joints=moment.joints)

truth = true_occupancy(grid, moment)
others = truth.occupied & ~truth.machine  # all but the machine itself
kept = ~space.free & others
seen = ~truth.occupied & ~truth.machine
print(f"touched by something: {others.sum()} voxels, of these called free: {(space.free & others).sum()}")
print(f"truly empty: {seen.sum()} voxels, of these found free: {100 * space.free[seen].mean():.1f} %")

# less evidence never adds free space: take one camera away, and another, and look for a voxel that became free
for lost in range(3):
    fewer = er.reconstruct(grid, cameras, frames[lost + 1 :], machine=room.machine, joints=moment.joints)
    more = int((fewer.free & ~space.free).sum())
    print(f"without {lost + 1} cameras: {100 * fewer.free.mean():.1f} % free, {more} voxels became free")
    assert more == 0
assert np.count_nonzero(kept) >= 0.999 * np.count_nonzero(others)
