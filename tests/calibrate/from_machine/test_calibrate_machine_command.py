import json

import numpy as np
import pytest
import yaml
from scipy.stats import chi2
from typer.testing import CliRunner

from elbowroom.cli import main
from elbowroom.cli.app import app
from elbowroom.geometry.twist import between, sizes
from elbowroom.site import Site


def call(*words):
    return CliRunner().invoke(app, ["calibrate", *map(str, words)])


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    folder = tmp_path_factory.mktemp("capture")
    done = call("simulate", "machine", "--out", folder, "--cameras", 3, "--size", "qqvga", "--poses", 8)
    assert done.exit_code == 0
    return folder


def truth_of(folder):
    cameras = yaml.safe_load((folder / "truth.yaml").read_text())["cameras"]
    return {name: np.array(camera["world_from_camera"]) for name, camera in cameras.items()}


def test_machine_writes_a_site_with_poses_covariance_and_margin_and_a_page(capture, tmp_path):
    out, report, rows = tmp_path / "new.yaml", tmp_path / "report", tmp_path / "rows.json"
    done = call("machine", capture, "--out", out, "--report", report, "--json", rows)
    assert done.exit_code == 0, done.output
    site, truth = Site.load(out), truth_of(capture)
    for camera in site.cameras():
        twist = between(camera.world_from_camera, truth[camera.name])
        metres, radians = sizes(twist)
        assert metres < 0.005
        assert np.degrees(radians) < 0.15
        covariance = site.pose_covariance(camera.name)
        assert twist @ np.linalg.solve(covariance, twist) < chi2.ppf(0.9999, 6)
        assert camera.margin.lateral_px > 0
    kinds = [row["kind"] for row in json.loads(rows.read_text())["rows"]]
    assert kinds.count("machine") == kinds.count("camera") == 3
    assert kinds.count("base") == 1
    page = (report / "report.html").read_text()
    assert page.count("data:image/png;base64") == 3
    assert "cam01" in page


def test_the_base_is_written_where_it_was_found(capture, tmp_path):
    site = yaml.safe_load((capture / "site.yaml").read_text())
    off = np.eye(4)
    off[:3, 3] = 0.03, -0.02, 0.04
    site["machine"]["world_from_base"] = off.tolist()
    truth = truth_of(capture)
    for camera in site["cameras"]:
        if camera["name"] == "cam00":
            camera["world_from_camera"] = truth["cam00"].tolist()
    moved = capture / "moved.yaml"
    moved.write_text(yaml.safe_dump(site))
    out = tmp_path / "new.yaml"
    done = call("machine", moved, "--base", "--hold", "cam00", "--out", out)
    assert done.exit_code == 0, done.output
    base = Site.load(out).machine().world_from_base
    metres, radians = sizes(between(base, np.eye(4)))
    assert metres < 0.004
    assert np.degrees(radians) < 0.1
    assert "sure to" in done.output


def failing(capsys, *words):
    with pytest.raises(SystemExit) as caught:
        main(["calibrate", *map(str, words)])
    assert caught.value.code != 0
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("elbowroom:")]
    assert len(lines) == 1
    return lines[0]


def test_what_cannot_be_found_is_one_line_and_no_site_file(capture, tmp_path, capsys):
    out = tmp_path / "new.yaml"
    assert "fixes the world" in failing(capsys, "machine", capture, "--hold", "cam00", "--out", out)
    assert "nothing fixes the world" in failing(capsys, "machine", capture, "--base", "--out", out)
    assert "no camera 'cam9'" in failing(capsys, "machine", capture, "--camera", "cam9", "--out", out)
    assert "--sure-to" in failing(capsys, "refine", capture, "--out", out)
    assert "mm and degrees" in failing(capsys, "refine", capture, "--sure-to", "much", "--out", out)
    assert not out.exists()


def test_joints_that_were_not_recorded_are_named(capture, tmp_path, capsys):
    site = yaml.safe_load((capture / "site.yaml").read_text())
    site["recording"]["joints_file"] = "absent.csv"
    path = capture / "no_joints.yaml"
    path.write_text(yaml.safe_dump(site))
    words = failing(capsys, "machine", path, "--out", tmp_path / "new.yaml")
    assert "absent.csv: no such file; expected joints as CSV" in words
    assert not (tmp_path / "new.yaml").exists()


def test_refine_goes_on_from_what_machine_wrote(capture, tmp_path):
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    assert call("machine", capture, "--out", first).exit_code == 0
    done = call("refine", first, "--out", second)
    assert done.exit_code == 0, done.output
    assert "agree" in done.output
    for camera in Site.load(second).cameras():
        metres, radians = sizes(between(camera.world_from_camera, truth_of(capture)[camera.name]))
        assert metres < 0.005
        assert np.degrees(radians) < 0.15
