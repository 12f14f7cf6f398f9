"""What the program writes as a site file, it reads."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import SiteError
from elbowroom.files.yaml_file import read_yaml, write_yaml
from elbowroom.site import Site
from elbowroom.site.paths import led_from
from elbowroom.site.update import update_site
from elbowroom.site.written import written, written_with_key

CONTENT = {
    "grid": {"origin_m": [0, 0, 0], "shape": [2, 2, 2], "voxel_size_m": 0.5},
    "simulated": {"cameras": 3},
}


def test_a_value_that_stands_twice_is_written_out_twice(tmp_path):
    point = [1.0, 2.0, 3.0]
    content = {"a": {"origin_m": point}, "b": {"origin_m": point}}
    assert read_yaml(write_yaml(tmp_path / "a.yaml", content, "two of one")) == content


def test_what_was_written_says_by_whom_and_is_a_site(tmp_path):
    path = written(CONTENT, tmp_path / "site.yaml", "written by a test")
    assert path.read_text().startswith("# written by a test\n")
    assert Site.load(path).simulated.cameras == 3


def test_what_is_no_site_is_not_called_written(tmp_path):
    with pytest.raises(SiteError, match=r"gird: unknown key \(did you mean grid\?\)"):
        written({**CONTENT, "gird": {}}, tmp_path / "site.yaml", "written by a test")


def test_a_key_is_replaced_and_all_else_stays_as_it_was_written(tmp_path):
    old = tmp_path / "old.yaml"
    text = (
        "# mine\ngrid: {origin_m: [0, 0, 0], shape: [2, 2, 2], voxel_size_m: 0.5}  # small\nsimulated: {}\n"
    )
    old.write_text(f"{text}watch:\n  reference: a.npz\n\n")
    new = written_with_key(Site.load(old), "watch", {"reference": "b.npz"}, tmp_path / "new.yaml", "a test")
    assert new.read_text().startswith(text) and new.read_text().count("watch:") == 1
    assert Site.load(new).entry.watch.reference == "b.npz"
    with pytest.raises(SiteError, match="is the site file itself"):
        written_with_key(Site.load(old), "watch", {}, old, "a test")


def test_what_is_written_again_keeps_comments_order_and_variables(tmp_path, monkeypatch):
    monkeypatch.setenv("WHERE", str(tmp_path))
    text = """# my room, measured in May
grid:
  origin_m: [0, 0, 0]  # the door's corner
  shape: [10, 10, 10]
  voxel_size_m: 0.1

cameras:
  # over the door
  - name: a
    width: 8
    height: 6
    noise: tof
    fx: 4.0
    fy: 4.0
    cx: 3.5
    cy: 2.5
    # by tape
    world_from_camera: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
recording:  # of Tuesday
  layout: folder
  folder: ${WHERE}/recording
"""
    (tmp_path / "old.yaml").write_text(text)
    site = Site.load(tmp_path / "old.yaml")
    (camera,) = site.cameras()
    pose = np.eye(4)
    pose[0, 3] = 0.25
    moved = replace(camera, world_from_camera=pose)
    (tmp_path / "elsewhere").mkdir()
    out = tmp_path / "elsewhere" / "new.yaml"
    update_site(site, [moved], {}, out, "extrinsics")
    said = out.read_text()
    for kept in (
        "# my room, measured in May",
        "# the door's corner",
        "# over the door",
        "# of Tuesday",
        "noise: tof",
        "folder: ${WHERE}/recording",
    ):
        assert kept in said
    assert said.index("grid:") < said.index("cameras:") < said.index("recording:")
    assert Site.load(out).cameras()[0].world_from_camera[0, 3] == 0.25
    # written over itself, one line says by what
    update_site(Site.load(out), [camera], {}, tmp_path / "third.yaml", "machine")
    again = (tmp_path / "third.yaml").read_text()
    assert again.count("by `elbowroom") == 1 and "calibrate machine" in again and "# over the door" in again


@pytest.mark.parametrize(
    ("text", "due"),
    [
        ("images", "../images"),
        ("${WHERE}/images", "${WHERE}/images"),
        ("${WHERE:-images}/a", "${WHERE:-../images}/a"),
        ("${WHERE:-/images}/a", "${WHERE:-/images}/a"),
    ],
)
def test_a_path_leads_from_another_folder_to_the_same_place(text, due, tmp_path, monkeypatch):
    monkeypatch.delenv("WHERE", raising=False)
    assert led_from(text, tmp_path, tmp_path / "below") == due
    assert led_from(text, tmp_path, tmp_path) == text
