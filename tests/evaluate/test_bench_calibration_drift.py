"""What the benchmark of the watch says is what the watch did."""

import numpy as np
import pytest

from elbowroom.evaluate import bench_calibration_drift as drift
from elbowroom.site import Site
from reference.watch_twins import CAMERAS, commissioned, walls


@pytest.fixture(scope="module")
def scene():
    return drift.commissioned("tof", 80, 60, count=5)


def test_a_knock_is_named_and_its_size_compared_with_the_true_one(scene, monkeypatch):
    monkeypatch.setattr(drift, "KNOCKS", {"turn 1 degree about y": drift.KNOCKS["turn 1 degree about y"]})
    alone, several = drift.knock_rows(scene, lambda words: None)
    assert (alone["runs"], alone["named"], alone["others_named"]) == (5, 5, 0)
    assert alone["frames_max"] <= drift.KNOCKED_FRAMES and alone["said_median"] == pytest.approx(1.0, abs=0.2)
    assert (several["runs"], several["named"], several["others_named"]) == (2, 2, 0)


def test_knocks_are_the_due_ones():
    assert len(drift.KNOCKS) == 6
    for knock in drift.KNOCKS.values():
        turn, move = np.degrees(np.linalg.norm(knock.turn_rad)), np.linalg.norm(knock.move_m)
        assert (turn, move) == pytest.approx((1.0, 0.0)) or (turn, move) == pytest.approx((0.0, 0.02))


def test_false_alarms_are_counted_over_frames_that_were_heard(scene):
    row = drift.false_alarm_row(scene, 8, lambda words: None)
    assert row["camera_frames"] == 4 * 3 + 4 * 2 and row["false_alarms"] == len(row["reasons"]) == 0


def test_a_camera_that_is_knocked_meanwhile_would_be_counted(scene, monkeypatch):
    rendered = drift.render

    def knocked(cameras, moment, **more):
        # a degree and a half, of every camera
        knock = drift.Knock("", (0, 0.026, 0))
        return rendered([knock.camera(camera) for camera in cameras], moment, **more)

    monkeypatch.setattr(drift, "render", knocked)
    row = drift.false_alarm_row(scene, 40, lambda words: None)
    assert row["false_alarms"] > 0 and row["frames_that_said_moved_pct"] > 20


def test_real_cameras_are_not_named_where_boxes_are_moved_and_named_where_they_stood_elsewhere(example_site):
    rows = list(drift.real_rows(Site.load(example_site("piv_table_2cam")), lambda words: None))
    none, *knocks = rows
    assert (none["knock"], none["named"], none["others_named"], none["passes"]) == ("none", False, 0, 90)
    assert len(knocks) == 6
    for row in knocks:
        assert row["named"] and row["others_named"] == 0 and row["passes"] <= 60
        assert row["said"] == pytest.approx(1.0 if row["unit"] == "deg" else 20.0, rel=0.25)


def test_a_reference_from_elsewhere_is_that_of_the_knocked_camera():
    camera = CAMERAS[0]
    knock = drift.Knock("", tuple(np.radians((0.6, -0.8, 0.3))), (0.01, -0.02, 0.015))
    (reference,) = commissioned([camera], 0.0)
    elsewhere = drift.commissioned_elsewhere(reference, knock)
    truth = walls(knock.camera(camera)).ravel()[elsewhere.pixel]
    # but where a ray has come to another wall
    same = np.abs(elsewhere.depth_m - truth) < 0.02
    assert same.mean() > 0.95 and np.abs(elsewhere.depth_m - truth)[same].max() < 0.01
