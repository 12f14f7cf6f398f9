"""What is wrong with a calibration names the option that helps."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from elbowroom.calibrate.boards.trouble import Fault, Trouble
from elbowroom.calibrate.result.calibrated_camera import CalibratedCamera
from elbowroom.cli.calibrate.commission_run import reference_table, that_tell_nothing
from elbowroom.cli.calibrate.extrinsics_run import told
from elbowroom.cli.calibrate.machine_run import MachineOptions, held
from elbowroom.cli.calibrate.refine_run import RefineOptions, pose_covariances
from elbowroom.cli.calibrate.result import ResultOptions, say_weak, write_result
from elbowroom.cli.calibrate.site import chosen_cameras, site_path
from elbowroom.errors import CalibrationError, InputError, NoResultError, SiteError
from elbowroom.geometry.twist import CAMERA_MOTIONS
from elbowroom.site import Site

RESULT = ResultOptions(out=Path("new.yaml"), report=None, confidence=0.95, near_m=None)
ROOM = """
name: hall
grid: {origin_m: [-2, -2, 0], upper_m: [2, 2, 2.5], voxel_size_m: 0.25}
camera_defaults: {width: 64, height: 48, fx: 32.0, fy: 32.0, cx: 31.5, cy: 23.5}
cameras:
  - {name: a, position_m: [2.0, 0.1, 2.4], look_at_m: [0.0, 0.0, 0.8]}
  - {name: b, position_m: [0.1, 2.0, 2.4], look_at_m: [0.0, 0.0, 0.8], pose_covariance: SURE}
"""
SURE = np.diag([1e-4] * 6)


@pytest.fixture
def site(tmp_path) -> Site:
    path = tmp_path / "site.yaml"
    path.write_text(ROOM.replace("SURE", str(SURE.tolist())))
    return Site.load(path)


def machine_options(base=True, hold=()):
    return MachineOptions(Path("site.yaml"), (), base, tuple(hold), 2.0, RESULT)


def refine_options(sure_to=None, hold=()):
    return RefineOptions(Path("site.yaml"), (), tuple(hold), sure_to, RESULT)


def test_named_cameras_hold_exactly_and_sure_ones_within_their_covariance(site):
    hold = held(site, machine_options(hold=["a"]), ["a", "b"])
    assert hold["a"] is None and hold["b"] == pytest.approx(SURE)
    assert held(site, machine_options(base=False), ["a", "b"]) == {}


@pytest.mark.parametrize(
    ("options", "cameras", "error", "words"),
    [
        (machine_options(base=False, hold=["a"]), ["a"], CalibrationError, "--hold: goes with --base"),
        (machine_options(hold=["c"]), ["a", "b"], SiteError, "--hold: no camera 'c'; cameras are a, b"),
        (machine_options(), ["a"], CalibrationError, "poses hold with --hold"),
    ],
)
def test_cameras_that_do_not_fix_the_world_are_one_line(site, options, cameras, error, words):
    with pytest.raises(error, match=words):
        held(site, options, cameras)


def test_a_pose_is_as_sure_as_the_site_says_or_else_as_the_option(site):
    found = pose_covariances(site, refine_options("50,3"), ["a", "b"])
    assert found["b"] == pytest.approx(SURE)
    assert np.sqrt(np.diag(found["a"])) == pytest.approx([np.radians(3)] * 3 + [0.05] * 3)
    assert pose_covariances(site, refine_options(hold=["a"]), ["a", "b"])["a"] is None


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        (refine_options(), CalibrationError, "camera a: .*say it with --sure-to"),
        (refine_options("50"), InputError, "--sure-to: '50' is not two numbers"),
        (refine_options("0,3"), InputError, "--sure-to: '0,3' is not two numbers above 0"),
        (refine_options("50,3", ["c"]), SiteError, "--hold: no camera 'c'"),
    ],
)
def test_a_pose_of_which_nothing_is_said_is_one_line(site, options, error, words):
    with pytest.raises(error, match=words):
        pose_covariances(site, options, ["a", "b"])


def test_only_named_cameras_are_chosen(site):
    assert [camera.name for camera in chosen_cameras(site, ())] == ["a", "b"]
    assert [camera.name for camera in chosen_cameras(site, ("b",))] == ["b"]
    with pytest.raises(SiteError, match="--camera: no camera 'c'; cameras are a, b"):
        chosen_cameras(site, ("c",))


def test_a_folder_stands_for_the_site_in_it(site, tmp_path):
    assert site_path(tmp_path) == site_path(site.path) == site.path
    site.path.unlink()
    with pytest.raises(InputError, match=r"has no site\.yaml"):
        site_path(tmp_path)


def test_a_moved_board_is_left_out_by_an_option():
    seen = SimpleNamespace(troubles=(Trouble("a", 2, Fault.NOT_SEEN),))
    moved = "pose 3 (and poses 4): cameras b, c do not agree where the board was (30 mm); it was moved"
    assert told(moved, seen) == f"{moved} (--without-pose 3)"
    anchor = "pose 3, in which the board's place is known, was seen by no camera; see"
    assert told(anchor, seen) == anchor
    few = "camera a sees the board in no pose"
    assert told(few, seen) == f"{few} (of 1 images without a view: camera a, pose 2: no board is seen)"


def test_a_reference_is_a_line_of_the_table(capsys):
    row = {
        "camera": "a",
        "spots": 480,
        "range_m": [0.51, 4.6],
        "turn_sigma_deg": [0.01, 0.02, 0.01],
        "move_sigma_mm": [0.1, 0.4, 0.2],
        "not_shown": [],
    }
    table = reference_table([row, row | {"not_shown": ["turn about z", "move along x"]}])
    one, other = table.lines
    assert one == ("a", "480", "0.5 to 4.6 m", "0.02°", "0.4 mm", "-")
    assert other[-1] == "turn about z, move along x"
    say_weak(["a: hold the board there"])
    assert capsys.readouterr().out == "weak      a: hold the board there\n"


def test_a_reference_that_tells_no_motion_at_all_is_none():
    row = {
        "camera": "a",
        "turn_sigma_deg": [0.3, 2.0, 1.0],
        "move_sigma_mm": [9.0, 30.0, 75.0],
        "not_shown": [*CAMERA_MOTIONS],
    }
    (doubt,) = that_tell_nothing([row, row | {"camera": "b", "not_shown": [*CAMERA_MOTIONS[1:]]}])
    assert doubt.startswith("a could be moved in any way") and "2.0 degrees and a move to 75 mm" in doubt


@pytest.mark.parametrize("command", ["extrinsics", "machine", "refine"])
@pytest.mark.parametrize(
    ("move_m", "sigma_m", "words"),
    [(0.0, 0.975, r"hardly known: a \(975 mm"), (2.5, 1e-3, "a by 2.5 m and 0 degrees"), (0.3, 0.02, None)],
)
def test_what_moves_by_metres_or_is_hardly_known_is_no_result_of_any_command(
    site, command, move_m, sigma_m, words, capsys
):
    before, other = site.cameras()
    pose = before.world_from_camera.copy()
    pose[0, 3] -= move_m
    covariance = np.diag([1e-8] * 3 + [sigma_m**2 / 3] * 3)
    moved = replace(before, world_from_camera=pose)
    found = [
        CalibratedCamera(moved, before, covariance, np.zeros(1), np.zeros(1)),
        CalibratedCamera(other, other, SURE * 1e-2, np.zeros(1), np.zeros(1)),
    ]
    options = replace(RESULT, out=site.path.with_name("new.yaml"), force_file=True)
    if words is None:
        write_result(site, found, options, command, lambda row: None)
        assert options.out.exists()
        return
    with pytest.raises(NoResultError, match=words):
        write_result(site, found, options, command, lambda row: None)
    assert sorted(path.name for path in site.path.parent.glob("new*")) == ["new.doubted.yaml"]
