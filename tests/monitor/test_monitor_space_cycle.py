"""The pass without motions: free space, or the reason why there is none."""

import numpy as np

from elbowroom.geometry import DepthCamera, Intrinsics, VoxelGrid
from elbowroom.monitor.space_cycle import SpaceCycle
from elbowroom.motion import Level
from elbowroom.reconstruct import Terms
from elbowroom.sensing import DepthFrame, Snapshot

GRID = VoxelGrid(origin_m=(-0.2, -0.2, 0.9), shape=(4, 4, 4), voxel_size_m=0.1)
CAMERA = DepthCamera("c0", 32, 24, np.eye(4), Intrinsics(30.0, 30.0, 15.5, 11.5))


def a_cycle() -> SpaceCycle:
    return SpaceCycle(GRID, [CAMERA], None, Terms("any"))


class Broken:
    """A snapshot of which nothing can be asked."""

    def __bool__(self) -> bool:
        return True

    def __getattr__(self, name):
        raise RuntimeError(f"no {name}")


def test_free_space_is_that_of_the_frames_and_nothing_is_free_without_them():
    cycle = a_cycle()
    far = DepthFrame("c0", 5, np.full((24, 32), 4.0))
    seen, unseen = cycle.run(Snapshot((far,), now_ns=5)), cycle.run(Snapshot(()))
    assert seen.space.free.all() and not unseen.space.free.any()
    assert (seen.sequence, unseen.sequence, seen.fault) == (0, 1, None)
    assert seen.level is Level.STOP and seen.verdicts == ()


def test_it_does_not_raise_whatever_the_snapshot_is():
    result = a_cycle().run(Broken())
    assert result.space is None and "RuntimeError: no" in result.fault and result.level is Level.STOP
