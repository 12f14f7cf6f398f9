"""A site file with calibrated cameras: all else stays, nothing is overwritten, covariances are read back."""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from elbowroom.errors import SiteError
from elbowroom.geometry import Intrinsics
from elbowroom.sensing import Margin
from elbowroom.site import Site
from elbowroom.site.update import update_site

SITE = """
# a comment
name: room
grid: {origin_m: [-1, -1, 0], upper_m: [1, 1, 2], voxel_size_m: 0.1}
camera_defaults: {width: 64, height: 48, fx: 50, fy: 50, cx: 31.5, cy: 23.5, noise: tof, depth_scale_m: 0.0002}
cameras:
  - {name: a, position_m: [-1, 0, 1], look_at_m: [0, 0, 1], max_depth_m: 5.0}
  - {name: b, position_m: [1, 0, 1], look_at_m: [0, 0, 1], depth_scale_m: 0.0001, margin: {bias_m: 0.01}}
rule: majority
margin: {lateral_px: 0.25}
"""
COVARIANCE = np.diag([1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6])


@pytest.fixture
def site(tmp_path):
    path = tmp_path / "old.yaml"
    path.write_text(SITE)
    return Site.load(path)


def test_only_what_was_found_is_replaced(site, tmp_path):
    camera = site.cameras()[1]
    pose = camera.world_from_camera.copy()
    pose[0, 3] += 0.5
    found = replace(camera, world_from_camera=pose, margin=Margin(bias_m=0.012, lateral_px=0.7))
    path = update_site(site, [found], {"b": COVARIANCE}, tmp_path / "new.yaml", "extrinsics")
    new = Site.load(path)
    a, b = new.cameras()
    np.testing.assert_allclose(a.world_from_camera, site.cameras()[0].world_from_camera)
    np.testing.assert_allclose(b.world_from_camera, pose, atol=1e-8)
    assert b.margin.bias_m == pytest.approx(0.012)
    assert new.depth_scale_m("b") == 0.0001
    assert a.max_depth_m == 5.0
    assert new.rule == "majority"
    np.testing.assert_allclose(new.pose_covariance("b"), COVARIANCE)
    assert new.pose_covariance("a") is None
    assert (tmp_path / "old.yaml").read_text() == SITE


def test_the_sensor_s_own_margin_is_kept_for_the_next_time(site, tmp_path):
    assert site.sensor_margin("a").lateral_px == 0.25
    assert site.sensor_margin("b").bias_m == 0.01
    wide = [replace(camera, margin=Margin(bias_m=0.5)) for camera in site.cameras()]
    new = Site.load(update_site(site, wide, {}, tmp_path / "new.yaml", "extrinsics"))
    assert new.cameras()[1].margin.bias_m == 0.5
    assert new.sensor_margin("b") == site.sensor_margin("b")
    assert new.sensor_margin("a") == site.sensor_margin("a")


def test_new_intrinsics_replace_the_shared_ones(site, tmp_path):
    lens = Intrinsics(51, 52, 31, 24, (0.1, 0, 0, 0, 0))
    found = replace(site.cameras()[0], intrinsics=lens)
    new = Site.load(update_site(site, [found], {}, tmp_path / "new.yaml", "intrinsics"))
    assert new.cameras()[0].intrinsics == lens
    assert new.cameras()[1].intrinsics == site.cameras()[1].intrinsics


def test_no_other_file_is_overwritten(site, tmp_path):
    with pytest.raises(SiteError, match="is the site file itself"):
        update_site(site, site.cameras(), {}, tmp_path / "old.yaml", "extrinsics")
    other = tmp_path / "other.yaml"
    other.write_text("notes: mine\n")
    with pytest.raises(SiteError, match="not written by a calibration"):
        update_site(site, site.cameras(), {}, other, "extrinsics")
    assert other.read_text() == "notes: mine\n"
    again = update_site(site, site.cameras(), {}, tmp_path / "new.yaml", "extrinsics")
    assert update_site(site, site.cameras(), {}, again, "extrinsics") == again


def test_paths_lead_to_the_same_files_from_another_folder(site, tmp_path):
    (tmp_path / "k.txt").write_text("50 0 31.5\n0 50 23.5\n0 0 1\n")
    content = yaml.safe_load(SITE)
    content["cameras"][0] = {"name": "a", "pose_file": "a.txt", "intrinsics_file": "k.txt"}
    (tmp_path / "a.txt").write_text("\n".join(" ".join(str(v) for v in row) for row in np.eye(4)))
    (tmp_path / "old.yaml").write_text(yaml.safe_dump(content))
    (tmp_path / "deep").mkdir()
    site = Site.load(tmp_path / "old.yaml")
    new = Site.load(update_site(site, site.cameras()[1:], {}, tmp_path / "deep" / "new.yaml", "extrinsics"))
    np.testing.assert_allclose(new.cameras()[0].world_from_camera, np.eye(4))


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (COVARIANCE + np.eye(6, k=1) * 1e-7, "symmetric"),
        (np.diag([1e-6, -1e-6, 1e-6, 1e-6, 1e-6, 1e-6]), "negative variance"),
        (np.diag([1e-6] * 5).tolist(), "pose_covariance"),
    ],
)
def test_a_covariance_that_is_none_is_refused(tmp_path, matrix, words):
    content = yaml.safe_load(SITE)
    content["cameras"][0]["pose_covariance"] = np.asarray(matrix).tolist()
    (tmp_path / "bad.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(SiteError, match=words):
        Site.load(tmp_path / "bad.yaml")
