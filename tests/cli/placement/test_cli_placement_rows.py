"""Rows and tables of the commands of `elbowroom placement`, and their messages."""

import pytest

from elbowroom.cli import run
from elbowroom.cli.placement.simulate import worth_table
from elbowroom.cli.placement.sweep import Swept, sweep_table
from elbowroom.cli.placement.verify import NO_WALLS, say_files, say_verification
from elbowroom.motion import Level
from elbowroom.placement.bill import bill_table
from elbowroom.placement.even import Sweep
from elbowroom.placement.in_use import FoundInUse
from elbowroom.placement.optimisation import Goal
from elbowroom.placement.rehearsal import Rehearsal, SceneResult

SWEEP = Sweep((11, 12, 13), (80.0, 96.5, 99.0), (85.0, 97.0, 99.5), 0.4, (0.1, 0.1, 0.1))
GO, STOP = Level.CLEAR, Level.STOP


def test_a_sweep_is_a_row_a_layout_and_one_for_all():
    rows = SWEEP.rows()
    assert [(row["cameras"], row["valid_pct"], row["seen_by_views_pct"]) for row in rows] == [
        (11, 80.0, 85.0),
        (12, 96.5, 97.0),
        (13, 99.0, 99.5),
    ]
    assert SWEEP.row(96.0) == {
        "kind": "sweep",
        "share_pct": 96.0,
        "least_cameras": 12,
        "layouts": 3,
        "best_valid_pct": 99.0,
    }


def test_the_table_of_a_sweep_leaves_out_numbers_that_were_not_tried():
    (line,) = sweep_table([Swept("hall", "vga", SWEEP, 2.345)], 99.9).lines
    assert line == ("hall", "vga", "0.4 m", "96.50 %", "", "", "none", "2.3 s")


def test_a_bill_ends_with_the_sum():
    prices = {"sensor_price": 100.0, "mount_price": 20.0, "cable_m": 5.0, "cable_price": 7.5, "price": 127.5}
    item = {"kind": "item", "camera": "a", "position_m": (1.0, -0.0, 2.4), "sensor": "vga", **prices}
    one, total = bill_table([item, {"kind": "total", "cameras": 1, **prices}]).lines
    assert one == ("a", "1.00, 0.00, 2.40", "vga", "100", "20", "5.0 m 7.50", "127.50")
    assert total == ("all", "", "", "100", "20", "5.0 m 7.50", "127.50")


@pytest.mark.parametrize(
    ("goal", "of"),
    [(Goal(cameras=9), "valid_pct"), (Goal(by_price=True), "price"), (Goal(), "cameras")],
)
def test_a_bound_is_of_what_the_goal_leaves_open(goal, of):
    assert goal.bound_of == of


def test_a_layout_by_scenes_says_its_steps():
    found = FoundInUse((), (), 81.0, 5.0, ((1.5, 7, 700.0, 0.8),), 12.0)
    assert found.row() == {"cameras": 0, "free_in_own_scenes_pct": 81.0, "bound": 5.0, "seconds": 12.0}
    (step,) = found.step_rows()
    assert step == {"kind": "step", "seconds": 1.5, "cameras": 7, "price": 700.0, "free_pct": 80.0}


def test_a_stop_is_false_only_where_the_truth_would_go():
    scenes = [
        SceneResult(80.0, 99.0, {"a": 5.0}, {"a": 9.0}, {"long +": (STOP, GO)}),
        SceneResult(90.0, 100.0, {"a": 7.0}, {"a": 11.0}, {"long +": (STOP, STOP)}),
        SceneResult(85.0, 100.0, {"a": 6.0}, {"a": 10.0}, {"long +": (GO, GO)}),
    ]
    done = Rehearsal(tuple(scenes))
    row = done.row()
    assert (row["scenes"], row["free_pct"], row["judged_motions"]) == (3, 85.0, 2)
    assert row["false_stop_pct"] == 50.0
    camera, motion = done.part_rows()
    assert camera == {"kind": "camera", "camera": "a", "contributes_pct": 6.0, "loss_pct": 10.0}
    assert motion == {"kind": "motion", "motion": "long +", "false_stops": 1, "scenes_without_stop": 2}


def test_the_camera_that_is_missed_most_comes_first():
    assert worth_table({"a": (1.0, 2.0), "b": (3.0, 4.0)}).lines == [
        ("b", "3.00 %", "4.00 %"),
        ("a", "1.00 %", "2.00 %"),
    ]


def test_what_was_verified_is_said_in_words(capsys, tmp_path):
    row = {
        "valid_pct": 71.5,
        "points": 2528,
        "voxel_size_m": 0.25,
        "views": 3,
        "angle_deg": 100.0,
        "seen_by_one_pct": 100.0,
        "seen_by_views_pct": 99.0,
        "mean_views": 6.54,
        "cameras": 7,
        "worst": [{"words": "below 0.5 m: nobody sees it"}],
    }
    say_verification(row)
    say_files([tmp_path / "plan.png", tmp_path / "new.yaml"], walls_known=False, site=tmp_path / "new.yaml")
    assert capsys.readouterr().out.splitlines() == [
        "valid     71.50 % of 2,528 points of 25 cm: 3 views, each two at least 100 degrees apart",
        "seen      100.00 % by one camera or more, 99.00 % by 3 or more; 6.5 of 7 cameras on average",
        "worst     below 0.5 m: nobody sees it",
        f"note      {NO_WALLS}",
        f"picture   {tmp_path / 'plan.png'}",
        f"site      {tmp_path / 'new.yaml'}",
    ]


def test_people_that_find_no_place_are_an_option(tmp_path, capsys):
    path = tmp_path / "narrow.yaml"
    path.write_text(
        "name: narrow\ngrid: {origin_m: [-1, -1, 0], upper_m: [1, 1, 2.5], voxel_size_m: 0.5}\n"
        "camera_defaults: {width: 16, height: 12, fx: 8.0, fy: 8.0, cx: 7.5, cy: 5.5}\n"
        "room: {walls: {lower_m: [-1.2, -1.2, 0.0], upper_m: [1.2, 1.2, 2.9]}}\n"
        "cameras: [{name: a, position_m: [1.1, 0.0, 2.4], look_at_m: [0.0, 0.0, 0.8]}]\n"
    )
    assert run(["placement", "simulate", str(path), "--people", "40", "--scenes", "1", "--no-table"]) == 2
    assert "--people: no place for person" in capsys.readouterr().err
