"""Moments in memory: played again and again, nothing jumps and no image follows itself."""

import numpy as np

from elbowroom.evaluate.moments import in_units, there_and_back
from elbowroom.sensing import DepthFrame
from elbowroom.site import Site
from elbowroom.sources import open_room

COUNT, RATE_HZ = 6, 15.0


def test_no_image_is_met_again_however_many_are_left_out():
    room = open_room(Site.simulated_room(), cameras=2, resolution=(64, 48))
    moments = there_and_back(room, COUNT, RATE_HZ)
    assert len(moments) == 2 * COUNT - 1
    for first, one in enumerate(moments):
        for other in moments[first + 1 :]:
            assert not any(
                np.array_equal(a.depth_m, b.depth_m) for a, b in zip(one.frames, other.frames, strict=True)
            )


def test_the_machine_never_jumps_farther_than_there():
    room = open_room(Site.simulated_room(), cameras=2, resolution=(64, 48))
    moments = there_and_back(room, COUNT, RATE_HZ)
    joints = np.array([list(moment.joints.values()) for moment in (*moments, moments[0])])
    steps = np.abs(np.diff(joints, axis=0)).max(axis=0)
    there = np.abs(np.diff(joints[:COUNT], axis=0)).max(axis=0)
    assert (there > 0).any() and (steps <= 1.5 * there + 1e-12).all()


def test_images_are_whole_millimetres_rounded_down_and_what_is_nothing_stays_nothing():
    depth = np.array([[1.2345, np.nan, np.inf, 0.9999]], np.float32)
    given = in_units(DepthFrame("a", 7, depth))
    assert given.camera == "a" and given.stamp_ns == 7
    found = np.where(np.isfinite(given.depth_m), given.depth_m, 0.0)
    assert np.allclose(found, [[1.234, 0.0, 0.0, 0.999]], atol=1e-6)
