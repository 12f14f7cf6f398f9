"""The monitor's look at whether anything in the grid is a surface."""

import numpy as np

from elbowroom.geometry import VoxelGrid
from elbowroom.geometry.margin import Margin
from elbowroom.monitor.health.nothing_look import FIRST, NothingLook
from elbowroom.sensing import DepthFrame, Snapshot
from reference import values_room as room

IN_MID_AIR = VoxelGrid((-0.6, -0.6, 1.9), (12, 12, 3), 0.1)
CAMERAS = room.cameras()


def snapshot(count, **other):
    return Snapshot(
        tuple(DepthFrame(c.name, 0, other.get(c.name, room.depth_of(c))) for c in CAMERAS[:count])
    )


def test_one_camera_that_sees_nothing_in_the_grid_stops_until_it_sees_something():
    look = NothingLook(IN_MID_AIR, CAMERAS[:1], Margin())
    for _ in range(FIRST + 2):
        (finding,) = look.hear(snapshot(1))
        assert finding.stops and finding.kind == "no surface"
    assert look.hear(snapshot(1, ne=np.full((room.HEIGHT, room.WIDTH), 2.2, np.float32))) == ()
    assert look.hear(snapshot(1)) == (), "something was seen there: the depths are depths"


def test_cameras_that_agree_on_what_lies_behind_stop_nothing():
    look = NothingLook(IN_MID_AIR, CAMERAS, Margin())
    assert all(look.hear(snapshot(4)) == () for _ in range(FIRST + 2))


def test_a_moment_without_frames_is_none():
    look = NothingLook(IN_MID_AIR, CAMERAS[:1], Margin())
    for _ in range(FIRST + 2):
        assert look.hear(Snapshot(())) == ()
    assert look.hear(snapshot(1))
