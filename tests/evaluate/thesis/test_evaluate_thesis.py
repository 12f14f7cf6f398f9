"""The thesis' experiments, small: one setup at 10 cm, its own sensor."""

import json

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.evaluate.shares.task import Settings
from elbowroom.evaluate.thesis.bands import BANDS, compared, counted
from elbowroom.evaluate.thesis.calibration import tasks as calibration_tasks
from elbowroom.evaluate.thesis.cases import cases_of, counts_of
from elbowroom.evaluate.thesis.draws import disturbed, judge_draws, margin_for
from elbowroom.evaluate.thesis.random_motions import judge_random
from elbowroom.evaluate.thesis.scale_model import scaled
from elbowroom.evaluate.thesis.thesis import TABLE_2, c_arm, sensor_cameras

SMALL = ["--setup", "6", "--voxel-size", "0.1", "--sensor", "64x48", "--jobs", "1"]


def rows_of(path):
    return json.loads(path.read_text())["rows"]


@pytest.mark.parametrize("command", ["reconstruction", "motions", "calibration", "scale", "more", "all"])
def test_help_shows_an_example(capsys, command):
    assert run(["evaluate", command, "--help"]) == 0
    assert f"elbowroom evaluate {command}" in capsys.readouterr().out.split("Example")[-1]


def test_reconstruction_of_one_setup_adds_up(tmp_path, capsys):
    out, json_file = tmp_path / "report", tmp_path / "out.json"
    assert run(["evaluate", "reconstruction", *SMALL, "--out", str(out), "--json", str(json_file)]) == 0
    rows = [row for row in rows_of(json_file) if row["kind"] == "reconstruction"]
    assert {(row["detail"], row["noise"]) for row in rows} == {
        (detail, noise) for detail in ("point", "footprint", "pixel") for noise in (False, True)
    }
    for row in rows:
        assert row["setup"] == 6 and row["part"] == "reconstruction"
        kept, lost = row["correct_object"], row["incorrect_object"]
        assert row["occupied_pct"] == pytest.approx(100 * kept / (kept + lost))
        free = row["correct_free"] + row["incorrect_free"]
        assert row["free_pct"] == pytest.approx(100 * row["correct_free"] / free)
        assert (row["thesis_free_pct"], row["thesis_occupied_pct"]) == TABLE_2[6]
    by = {(row["detail"], row["noise"]): row for row in rows}
    assert by["footprint", False]["occupied_pct"] > by["pixel", False]["occupied_pct"] > 95
    assert by["point", False]["occupied_pct"] < 70
    page = (out / "report.html").read_text()
    assert "<h2" in page and 'src="http' not in page and "<script" not in page
    assert "Thesis: free 98.9" in capsys.readouterr().out


def test_motions_of_one_setup_are_never_unsafe(tmp_path):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    json_file = tmp_path / "out.json"
    assert run(["evaluate", "motions", *SMALL, "--motions", "0", "--json", str(json_file)]) == 0
    movements = [row for row in rows_of(json_file) if row["kind"] == "movement"]
    assert {row["motion"] for row in movements} == {"Carc Rotation", "2 x Carc Rotation"}
    for row in movements:
        assert row["verdict"] == compared(row["band"], row["truth_band"])
        assert row["detail"] == "point" or row["verdict"] != "u"
        assert row["detail"] == "point" or row["free_travel"] <= row["truth_travel"] + 1e-6


def test_random_motions_are_those_whose_truth_is_within_l():
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    rows = judge_random(number=6, seed=0, count=2, cameras=3, voxel_size_m=0.1, careful=True).rows
    within = [row for row in rows if row["kind"] == "random" and row["lateral_px"] == 0]
    assert len(within) == 2 and all(row["truth_band"] in "SML" and row["true_solid"] for row in within)
    for bare, careful in zip(
        within, [r for r in rows if r["kind"] == "random" and r["lateral_px"] > 0], strict=True
    ):
        assert careful["truth_travel"] == bare["truth_travel"]
        assert careful["free_travel"] <= bare["free_travel"]
    counts = [row for row in rows if row["kind"] == "joint" and row["lateral_px"] == 0]
    assert sum(row["motions"] for row in counts) % 8 == 0 and len(counts) == 4
    assert not any(row["more_than_truth"] for row in rows)


def test_margin_keeps_objects_that_a_calibration_error_would_lose():
    case = {
        "curve": "rotation",
        "size": "qqvga",
        "rotation_deg": 3.0,
        "translation_m": 0.0,
        "shares": [0.0, 0.75],
    }
    rest = {"number": 1, "voxel_size_m": 0.1, "first": 0, "draws": 1, "cameras": 21}
    bare, kept = judge_draws(case, **rest).rows
    assert kept["occupied_pct"] > bare["occupied_pct"] and kept["found_pct"] < bare["found_pct"]


def test_draws_are_the_same_in_whatever_shares_they_come():
    settings = Settings(draws=30)
    names = [task.name for task in calibration_tasks(settings)]
    assert len(set(names)) == len(names)
    due = [t.arguments for t in calibration_tasks(settings) if t.arguments["errors"]["curve"] == "due"]
    assert [(a["first"], a["draws"]) for a in due] == [(0, 25), (25, 5)]


@pytest.mark.parametrize("band", BANDS)
@pytest.mark.parametrize("truth", BANDS)
def test_less_safe_than_the_truth_is_unsafe_and_nothing_else_is(band, truth):
    verdict = compared(band, truth)
    assert (verdict == "u") == (BANDS.index(band) > BANDS.index(truth))
    assert (verdict == "s") == (band == truth)
    assert (verdict == "tts") == (band == "S" and truth == "0")


def test_counts_of_verdicts():
    assert counted(["s", "u", "s"]) == {"s": 2, "ts": 0, "tts": 0, "u": 1}


def test_the_four_cases_are_those_of_table_1():
    free = np.array([True, False, False, True, True])
    occupied = np.array([False, False, True, True, False])
    machine = np.array([False, False, False, False, True])
    cases = cases_of(free, occupied, machine)
    assert cases.tolist() == [1, 2, 3, 4, 0]
    assert list(counts_of(cases).values()) == [1, 1, 1, 1]


def test_disturbed_cameras_are_off_by_no_more_than_the_error():
    cameras = sensor_cameras("64x48", count=5)
    for camera, said in zip(cameras, disturbed(cameras, 1.0, 0.01, np.random.default_rng(1)), strict=True):
        assert np.abs(said.centre_in_world - camera.centre_in_world).max() <= 0.01
        turned = camera.world_from_camera[:3, :3].T @ said.world_from_camera[:3, :3]
        assert np.degrees(np.arccos((np.trace(turned) - 1) / 2)) <= 1.01 * np.sqrt(3)
    assert margin_for(0.0, 0.0, 1.0, 320.0).lateral_px == 0.5


def test_a_scaled_machine_is_the_same_but_smaller():
    machine, small = c_arm(), scaled(c_arm(), 0.2)
    joints = {"long": 0.3, "larm": 0.5, "propeller": -0.4, "carc": 0.2}
    whole, model = machine.world_from_links(joints), small.world_from_links({**joints, "long": 0.06})
    for name in machine.link_names:
        assert model[name][:3, 3] == pytest.approx(0.2 * whole[name][:3, 3])
        assert model[name][:3, :3] == pytest.approx(whole[name][:3, :3])


def test_an_unknown_sensor_is_one_line(capsys):
    assert run(["evaluate", "reconstruction", "--sensor", "radar"]) == 2
    assert "640x480, 64x48" in capsys.readouterr().err
