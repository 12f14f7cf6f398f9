"""The simulated room as a source: as time goes on, with knocks."""

import numpy as np
import pytest

from elbowroom.simulate import InterventionRoom, render, wall_cameras
from elbowroom.simulate.knock import Knock
from elbowroom.simulate.rounds import walking_staff
from elbowroom.sources.simulated import Simulated

CAMERAS = wall_cameras(2, width=32, height=24)
TIMES_S = (0.5, 1.5)


def test_snapshots_are_the_rooms_at_these_times():
    room = InterventionRoom(staff=walking_staff())
    for number, (time_s, snapshot) in enumerate(
        zip(TIMES_S, Simulated(CAMERAS, seed=4).at(TIMES_S), strict=True)
    ):
        moment = room.at(time_s)
        assert snapshot.now_ns == moment.stamp_ns and snapshot.joints == moment.joints
        for seen, frame in zip(snapshot.frames, render(CAMERAS, moment, seed=4 + number), strict=True):
            assert np.array_equal(seen.depth_m, frame.depth_m, equal_nan=True)
            assert seen.stamp_ns == moment.stamp_ns


def test_time_goes_on_and_begins_anew_with_each_iteration():
    source = Simulated(CAMERAS)
    for _ in range(2):
        snapshots = iter(source)
        first, second = next(snapshots), next(snapshots)
        assert first.now_ns < second.now_ns < 60e9
        assert first.oldest_age_ms == 0.0


def test_joints_that_are_given_hold_throughout():
    joints = dict.fromkeys(InterventionRoom().at(0.0).joints, 0.1)
    assert [snapshot.joints for snapshot in Simulated(CAMERAS, joints=joints).at(TIMES_S)] == [joints] * 2


def test_a_knocked_camera_sees_something_else_from_then_on_and_a_knocked_joint_tells_it():
    knocks = (Knock.parse("cam00:5deg@1"), Knock.parse("larm:2deg@1"))
    before, after = Simulated(CAMERAS, knocks=knocks).at(TIMES_S)
    plain_before, plain_after = Simulated(CAMERAS).at(TIMES_S)

    def same(one, other):
        return [
            np.array_equal(a.depth_m, b.depth_m, equal_nan=True)
            for a, b in zip(one.frames, other.frames, strict=True)
        ]

    assert same(before, plain_before) == [True, True] and before.joints == plain_before.joints
    assert same(after, plain_after) == [False, True]
    assert after.joints["larm"] == pytest.approx(plain_after.joints["larm"] - np.radians(2))


def test_cameras_that_are_exposed_one_after_the_other_say_when_and_see_what_was_then():
    together, skewed = (
        next(iter(Simulated(CAMERAS, seed=4, skew_ms=skew).at([TIMES_S[1]]))) for skew in (0.0, 80.0)
    )
    ages_ms = [(skewed.now_ns - frame.stamp_ns) / 1e6 for frame in skewed.frames]
    assert min(ages_ms) == pytest.approx(0, abs=1e-3) and max(ages_ms) == pytest.approx(80, abs=1e-3)
    assert skewed.joints == together.joints and set(skewed.joints_of) == {c.name for c in CAMERAS}
    for frame, same, age in zip(skewed.frames, together.frames, ages_ms, strict=True):
        assert frame.camera == same.camera
        (then,) = (
            f
            for f in next(iter(Simulated(CAMERAS, seed=4).at([TIMES_S[1] - age / 1e3]))).frames
            if f.camera == frame.camera
        )
        np.testing.assert_array_equal(frame.depth_m, then.depth_m)
