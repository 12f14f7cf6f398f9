"""`elbowroom calibrate simulate`: what it writes is what the calibrating commands read, with the truth beside it."""

import json

import numpy as np
import pytest
import yaml
from scipy.stats import chi2
from typer.testing import CliRunner

from elbowroom.calibrate import Board
from elbowroom.calibrate.extrinsics.site_anchor import anchor_of
from elbowroom.calibrate.simulated import Start, hand_poses, read_truth, started
from elbowroom.calibrate.simulated.hand_poses import shown
from elbowroom.calibrate.simulated.stand_poses import stand_poses
from elbowroom.cli.app import app
from elbowroom.errors import CalibrationError, InputError
from elbowroom.geometry import invert_rigid
from elbowroom.geometry.lens import project
from elbowroom.geometry.twist import log
from elbowroom.simulate import wall_cameras
from elbowroom.site import Site
from elbowroom.sources.layouts.layout import layout_of

RUNNER = CliRunner()
BOARD = Board(8, 5, 0.1, "cut_out", 0.04, marked=True, thickness_m=0.003)


def call(*arguments):
    return RUNNER.invoke(app, ["calibrate", *map(str, arguments)], catch_exceptions=False)


def test_near_poses_fill_the_image():
    (bent,) = started(wall_cameras(1), Start(focal_pct=2.0, lens=True), np.random.default_rng(3))
    camera = bent.true
    poses = hand_poses([camera], BOARD, 12, np.random.default_rng(4), near=True)
    covered = np.zeros((3, 3), dtype=bool)
    for pose in poses:
        camera_from_board = camera.camera_from_world @ pose
        points = np.concatenate([BOARD.outline_in_board, BOARD.corners_in_board])
        points = points @ camera_from_board[:3, :3].T + camera_from_board[:3, 3]
        pixels, _ = project(camera.intrinsics, points)
        assert pixels.min() > 0 and (pixels < (639, 479)).all()
        assert (np.ptp(pixels, axis=0) / (640, 480)).max() > 0.35
        sight = points.mean(axis=0) / np.linalg.norm(points.mean(axis=0))
        assert np.degrees(np.arccos(abs(camera_from_board[:3, 2] @ sight))) < 50
        ninth = np.floor(3 * (pixels[4:] + 0.5) / (640, 480)).astype(int)
        covered[ninth[:, 1], ninth[:, 0]] = True
    assert covered.all()


def test_a_capture_with_near_poses_gives_intrinsics(tmp_path):
    out, rows = tmp_path / "capture", tmp_path / "rows.json"
    size = ("--cameras", 1, "--size", "qqvga", "--poses", 8, "--near", "--focal", 2, "--depth-bias", 0.01)
    done = call("simulate", "board", "--out", out, *size, "--noise", "exact", "--json", rows)
    assert done.exit_code == 0
    assert f"now: elbowroom calibrate intrinsics {out / 'site.yaml'}" in done.stdout
    (row,) = json.loads(rows.read_text())["rows"]
    assert (row["cameras"], row["poses"]) == (1, 8)
    site, truth = Site.load(out / "site.yaml"), read_truth(out)["cameras"]["cam00"]
    assert row["images"] == len(layout_of(site).by_camera()["cam00"])
    new = tmp_path / "new.yaml"
    page = tmp_path / "report"
    done = call("intrinsics", out, "--distortion", 0, "--out", new, "--json", rows, "--report", page)
    assert done.exit_code == 0
    text = (page / "report.html").read_text()
    for words in (
        "Lenses and depth",
        "Residuals per camera",
        "corners over all",
        "circles where corners should be",
    ):
        assert words in text
    k = Site.load(new).cameras()[0].intrinsics
    found = json.loads(rows.read_text())["rows"][0]
    assert abs(k.fx - truth["fx"]) < 4 * found["sigma"][0]
    assert found["sigma"][0] < 0.01 * k.fx


def test_a_capture_with_stands_fixes_the_world_by_what_was_measured_there(tmp_path):
    out, rows = tmp_path / "capture", tmp_path / "rows.json"
    size = ("--cameras", 4, "--size", "qqvga", "--poses", 8, "--stands", 3)
    assert call("simulate", "board", "--out", out, *size).exit_code == 0
    site, truth = Site.load(out / "site.yaml"), read_truth(out)
    anchor = anchor_of(site)
    assert [point.pose for point in anchor.points] == [0, 0, 0, 1, 1, 1, 2, 2, 2]
    off = []
    for point in anchor.points:
        true = np.array(truth["poses"][point.pose]["world_from_board"]) @ np.append(point.board_m, 1)
        off.append(point.world_m - true[:3])
    assert 0.3 * anchor.sigma_m < np.std(off) < 2 * anchor.sigma_m
    new, page = tmp_path / "new.yaml", tmp_path / "report"
    done = call("extrinsics", out, "--out", new, "--report", page, "--json", rows)
    assert done.exit_code == 0
    assert "world     9 measured points," in done.stdout
    assert "Points of known place, which fix the world" in (page / "report.html").read_text()
    assert len(json.loads(rows.read_text())["rows"][-1]["points_off_m"]) == 9
    found = Site.load(new)
    for camera in found.cameras():
        true = np.array(truth["cameras"][camera.name]["world_from_camera"])
        error = log(invert_rigid(camera.world_from_camera) @ true)
        assert error @ np.linalg.solve(found.pose_covariance(camera.name), error) < chi2.ppf(0.9999, 6)
        assert np.linalg.norm(error[3:]) < 0.04
    content = yaml.safe_load((out / "site.yaml").read_text())
    content["recording"]["folder"] = str(out / "images")
    for point in content["calibration"]["world"]["points"][3:6]:
        point["world_m"][0] += 0.1
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(yaml.safe_dump(content))
    with pytest.raises(
        CalibrationError, match=r"^pose 1: the measured place of stand 1, .* lies (9\d|1\d\d) mm from"
    ):
        call("extrinsics", wrong, "--out", tmp_path / "never.yaml")
    assert not (tmp_path / "never.yaml").exists()


def test_stands_are_apart_face_up_and_in_view():
    cameras = wall_cameras(21, size="thesis")
    board = Board(5, 4, 0.18, "cut_out", 0.04, marked=True, thickness_m=0.003)
    poses = stand_poses(cameras, board, 3, np.random.default_rng(5))
    middles = [(pose @ np.append(board.corners_in_board.mean(axis=0), 1))[:3] for pose in poses]
    for number, pose in enumerate(poses):
        assert pose[2, 2] < 0
        assert all(np.linalg.norm(middles[number] - other) > 0.7 for other in middles[:number])
        views = [shown(camera, board, pose) for camera in cameras]
        assert sum(view.whole and view.front for view in views) >= 2


def test_tiny_images_get_stands_unless_told_otherwise(tmp_path):
    size = ("--cameras", 2, "--size", "thesis", "--poses", 3)
    for out, more, by in ((tmp_path / "a", (), "points"), (tmp_path / "b", ("--stands", 0), "board")):
        assert call("simulate", "board", "--out", out, *size, *more).exit_code == 0
        assert Site.load(out / "site.yaml").entry.calibration.world.by == by


def test_a_knocked_camera_is_elsewhere_than_the_site_says(tmp_path):
    size = ("--cameras", 2, "--size", "thesis", "--poses", 2, "--wrong-deg", 0, "--wrong-m", 0)
    done = call("simulate", "room", "--out", tmp_path, *size, "--knock", "cam01", "--knock-m", 0.03)
    assert done.exit_code == 0
    assert "calibrate refine" in done.stdout
    truth = read_truth(tmp_path)["cameras"]
    off = [
        np.linalg.norm(
            camera.world_from_camera[:3, 3] - np.array(truth[camera.name]["world_from_camera"])[:3, 3]
        )
        for camera in Site.load(tmp_path / "site.yaml").cameras()
    ]
    assert off == pytest.approx([0.0, 0.03], abs=1e-6)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("room", "--near"), "--near with room: near poses are those of a board"),
        (("room", "--noise", "kinect"), "--noise: 'kinect' is unknown, allowed are exact, "),
        (("room", "--knock", "north"), "knocked camera 'north': unknown; cameras are cam00, cam01"),
        (("board", "--corners", "8x6"), "odd"),
        (("board", "--poses", 3, "--stands", 4), "4 stands, must be 0 to the 3 poses"),
    ],
)
def test_what_cannot_be_simulated_is_one_line(tmp_path, arguments, expected):
    with pytest.raises(InputError) as caught:
        call("simulate", *arguments, "--cameras", 2, "--size", "thesis", "--out", tmp_path / "capture")
    assert expected in str(caught.value) and "\n" not in str(caught.value)
    assert not (tmp_path / "capture" / "site.yaml").exists()
