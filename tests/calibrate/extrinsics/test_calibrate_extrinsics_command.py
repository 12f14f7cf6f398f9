"""`elbowroom calibrate extrinsics` from a capture on disk to a site file; and on a real recording."""

import json

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from elbowroom.calibrate.refinement.agreement import agreement
from elbowroom.calibrate.result.change import pose_difference
from elbowroom.cli.app import app
from elbowroom.errors import CalibrationError, InputError
from elbowroom.site import Site
from elbowroom.sources import moments

RUNNER = CliRunner()


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    """Four cameras of 640x480 and nine poses of a cut-out board."""
    out = tmp_path_factory.mktemp("capture")
    arguments = ["calibrate", "simulate", "board", "--out", str(out), "--cameras", "4", "--poses", "9"]
    done = RUNNER.invoke(app, arguments, catch_exceptions=False)
    assert done.exit_code == 0
    return out


def run(*arguments):
    return RUNNER.invoke(app, ["calibrate", "extrinsics", *map(str, arguments)], catch_exceptions=False)


def test_from_images_to_a_site_with_margins(capture, tmp_path):
    new, rows = tmp_path / "new.yaml", tmp_path / "rows.json"
    done = run(capture, "--out", new, "--report", tmp_path / "report", "--json", rows)
    assert done.exit_code == 0
    site, old = Site.load(new), Site.load(capture / "site.yaml")
    truth = yaml.safe_load((capture / "truth.yaml").read_text())["cameras"]
    for camera, before in zip(site.cameras(), old.cameras(), strict=True):
        true = np.array(truth[camera.name]["world_from_camera"])
        moved, turned = pose_difference(camera.world_from_camera, true)
        was, _ = pose_difference(before.world_from_camera, true)
        assert was > 0.03
        assert moved < 0.03
        assert np.degrees(turned) < 1.0
        assert camera.margin.lateral_px > before.margin.lateral_px if before.margin else camera.margin
        assert site.pose_covariance(camera.name).shape == (6, 6)
        assert site.sensor_margin(camera.name) == old.sensor_margin(camera.name)
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.count("<img") > 8
    assert 'src="http' not in page
    kinds = [row["kind"] for row in json.loads(rows.read_text())["rows"]]
    assert kinds == ["camera"] * 4 + ["capture"]


def test_nothing_is_written_where_something_is_wrong(capture, tmp_path):
    content = yaml.safe_load((capture / "site.yaml").read_text())
    content["recording"]["folder"] = str(capture / "images")
    del content["calibration"]["world"]
    path = tmp_path / "site.yaml"
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(CalibrationError, match=r"calibration\.world: missing"):
        run(path, "--out", tmp_path / "new.yaml")
    assert not (tmp_path / "new.yaml").exists()
    with pytest.raises(InputError, match="is the site file itself"):
        run(path, "--out", path)
    with pytest.raises(InputError, match=r"has no site\.yaml"):
        run(capture / "images", "--out", tmp_path / "new.yaml")


def test_two_real_cameras_agree_after_calibration(data_folder, tmp_path, request):
    data_folder("kinect_board_2cam")
    example = request.config.rootpath / "examples" / "kinect_board_2cam_calibration.yaml"
    assert run(example, "--out", tmp_path / "new.yaml").exit_code == 0
    site = Site.load(tmp_path / "new.yaml")
    one, other = site.cameras()
    depth = {}
    for frame in next(iter(moments(site))).frames:
        inside = (frame.depth_m > one.min_depth_m) & (frame.depth_m < one.max_depth_m)
        depth[frame.camera] = np.where(inside, frame.depth_m, 0).astype(np.float32)
    assert agreement(one, depth["left"], other, depth["right"]).agree_pct > 80
    assert agreement(other, depth["right"], one, depth["left"]).agree_pct > 80
