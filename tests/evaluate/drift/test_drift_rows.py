"""What the benchmark of the watch says is what the watch did."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.evaluate.drift import false_alarms, knocks, recorded
from elbowroom.evaluate.drift import scene as scenes
from elbowroom.geometry import looking_at
from elbowroom.sensing import NOISE_PRESETS
from elbowroom.simulate import InterventionRoom, wall_cameras
from elbowroom.simulate.knock import Knock
from elbowroom.site import Site
from reference.watch_twins import CAMERAS, commissioned, walls


@pytest.fixture(scope="module")
def scene():
    return scenes.commissioned("tof", 80, 60, count=5)


def test_a_knock_is_named_and_its_size_compared_with_the_true_one(scene, monkeypatch):
    monkeypatch.setattr(knocks, "KNOCKS", {"turn 1 degree about y": knocks.KNOCKS["turn 1 degree about y"]})
    alone, several = knocks.knock_rows(scene, lambda words: None)
    assert (alone["runs"], alone["named"], alone["others_named"]) == (5, 5, 0)
    assert alone["frames_max"] <= scenes.KNOCKED_FRAMES and alone["said_median"] == pytest.approx(
        1.0, abs=0.2
    )
    assert (several["runs"], several["named"], several["others_named"]) == (2, 2, 0)


def test_knocks_are_the_due_ones():
    assert len(knocks.KNOCKS) == 6
    for knock in knocks.KNOCKS.values():
        turn, move = np.degrees(np.linalg.norm(knock.turn_rad)), np.linalg.norm(knock.move_m)
        assert (turn, move) == pytest.approx((1.0, 0.0)) or (turn, move) == pytest.approx((0.0, 0.02))


def test_false_alarms_are_counted_over_frames_that_were_heard(scene):
    row = false_alarms.false_alarm_row(scene, 8, lambda words: None)
    assert row["camera_frames"] == 4 * 3 + 4 * 2 and row["false_alarms"] == len(row["reasons"]) == 0


def test_a_camera_that_is_knocked_meanwhile_would_be_counted(scene, monkeypatch):
    rendered = scenes.render

    def knocked(cameras, moment, **more):
        # a degree and a half, of every camera
        knock = Knock("", (0, 0.026, 0))
        return rendered([knock.camera(camera) for camera in cameras], moment, **more)

    monkeypatch.setattr(scenes, "render", knocked)
    row = false_alarms.false_alarm_row(scene, 40, lambda words: None)
    assert row["false_alarms"] > 0 and row["frames_that_said_moved_pct"] > 20


def test_real_cameras_are_not_named_where_boxes_are_moved_and_named_where_they_stood_elsewhere(example_site):
    rows = list(recorded.recorded_rows(Site.load(example_site("piv_table_2cam")), lambda words: None))
    none, *moved = rows
    assert (none["knock"], none["named"], none["others_named"], none["passes"]) == ("none", False, 0, 90)
    assert len(moved) == 6
    for row in moved:
        assert row["named"] and row["others_named"] == 0 and row["passes"] <= 60
        assert row["said"] == pytest.approx(1.0 if row["unit"] == "deg" else 20.0, rel=0.25)


def test_a_reference_from_elsewhere_is_that_of_the_knocked_camera():
    camera = CAMERAS[0]
    knock = Knock("", tuple(np.radians((0.6, -0.8, 0.3))), (0.01, -0.02, 0.015))
    (reference,) = commissioned([camera], 0.0)
    elsewhere = recorded.commissioned_elsewhere(reference, knock)
    truth = walls(knock.camera(camera)).ravel()[elsewhere.pixel]
    # but where a ray has come to another wall
    same = np.abs(elsewhere.depth_m - truth) < 0.02
    assert same.mean() > 0.95 and np.abs(elsewhere.depth_m - truth)[same].max() < 0.01


def test_a_camera_before_a_corner_is_named_by_a_part_and_no_image_shows_the_rest(monkeypatch):
    # it sees two walls, neither floor nor ceiling
    first, second = wall_cameras(
        2, 2.4, 80, 60, noise=NOISE_PRESETS["tof"], optics=replace(scenes.RANGE, hfov_deg=60)
    )
    before = replace(first, world_from_camera=looking_at((1.5, -1.55, 0.9), (2.05, -2.05, 1.15)))
    both = scenes.commissioned_by((before, second), InterventionRoom(), "tof")
    corner = replace(both, cameras=both.cameras[:1], references=both.references[:1])
    monkeypatch.setattr(knocks, "KNOCKS", {"move 2 cm along y": knocks.KNOCKS["move 2 cm along y"]})
    alone = next(knocks.knock_rows(corner, lambda words: None))
    assert (alone["named"], alone["others_named"], alone["said_median"]) == (1, 0, None)
    assert list(alone["named_by_a_part"]) == ["cam00"]
    (row,) = knocks.not_shown_rows(corner)
    assert row["camera"] == "cam00" and row["not_shown"] == "moving up and down"
    # a move of 2 cm that the room shows changes images by millimetres
    assert row["differs_mm"] < 1.0 and row["differs_sigmas"] < 0.5
    assert not list(
        knocks.not_shown_rows(replace(both, cameras=both.cameras[1:], references=both.references[1:]))
    )
