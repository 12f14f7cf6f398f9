"""`elbowroom simulate SITE`: a site's own cell as a recording that the site itself reads."""

import json
import signal

import numpy as np
import pytest
import yaml

from elbowroom.cli import run
from elbowroom.simulate import sensor
from elbowroom.site import Site
from elbowroom.sources import moments
from reference.table_cell import POSE, cell, table_cell

__all__ = ["cell"]
FEW = ["--moments", "2", "--joints", POSE]


def test_the_site_reads_what_its_own_cameras_would_see(cell, tmp_path):
    assert run(["simulate", str(cell), *FEW, "--json", str(tmp_path / "a.json")]) == 0
    site = Site.load(cell)
    first, second = moments(site)
    assert second.now_ns - first.now_ns == 100_000_000 and len(str(first.now_ns)) == len(str(second.now_ns))
    assert {frame.camera for frame in first.frames} == {camera.name for camera in site.cameras()}
    assert first.joints["elbow"] == pytest.approx(np.radians(65)) and second.joints != first.joints
    (row,) = json.loads((tmp_path / "a.json").read_text())["rows"]
    assert (row["moments"], row["images"], row["cameras"]) == (2, 12, 6)


def test_images_are_exact_where_the_cameras_are_and_counted_as_the_site_reads_them(tmp_path):
    path = table_cell(tmp_path)
    content = yaml.safe_load(path.read_text())
    content["camera_defaults"] |= {"noise": "exact", "depth_scale_m": 0.0005, "depth_bias_m": 0.02}
    path.write_text(yaml.safe_dump(content))
    assert run(["simulate", str(path), "--moments", "1", "--joints", POSE]) == 0
    (moment,) = moments(Site.load(path))
    nw = next(camera for camera in Site.load(path).cameras() if camera.name == "nw")
    points = nw.points_in_world(next(f for f in moment.frames if f.camera == "nw").depth_m)
    inside = (np.abs(points[..., :2]) < 2.0).all(axis=-1)
    floor = points[inside & (np.abs(points[..., 2]) < 0.03)]
    assert len(floor) > 100 and np.percentile(np.abs(floor[:, 2]), 97) < 0.002


def test_machine_and_people_move_or_stand_still_as_asked(cell):
    assert run(["simulate", str(cell), *FEW, "--rate", "1", "--still", "--moving", "person"]) == 0
    first, second = moments(Site.load(cell))
    assert first.joints == second.joints
    changed = [np.abs(a.depth_m - b.depth_m) > 0.5 for a, b in zip(first.frames, second.frames, strict=True)]
    assert max(np.mean(image) for image in changed) > 0.02


def test_another_folder_gets_a_site_file_and_the_truth(cell, tmp_path, capsys):
    out = tmp_path / "elsewhere"
    argv = ["simulate", str(cell), *FEW, "--out", str(out), "--noise", "exact", "--truth"]
    assert run(argv) == 0
    assert "recording: {layout: folder, folder: elsewhere/images}" in capsys.readouterr().out
    site = Site.load(out / "site.yaml")
    assert all(camera.noise is None for camera in site.cameras()) and site.machine() is not None
    assert len(list(moments(site))) == 2 and (out / "colour.png").is_file()
    for path in (out / "truth").iterdir():
        with np.load(path) as truth:
            assert truth["occupied"].shape == site.grid().shape and truth["machine"].any()
    assert not (tmp_path / "recording").exists()


def test_what_another_run_left_is_replaced_and_what_others_left_is_not(cell, tmp_path, capsys):
    assert run(["simulate", str(cell), *FEW]) == 0
    content = yaml.safe_load(cell.read_text())
    gone = content["cameras"].pop()["name"]
    cell.write_text(yaml.safe_dump(content))
    assert run(["simulate", str(cell), "--moments", "1", "--joints", POSE]) == 0
    assert not (tmp_path / "recording" / gone).exists()
    assert len(list((tmp_path / "recording").glob("*/*.png"))) == 5
    (tmp_path / "recording" / "nw" / "123.png").write_bytes(b"mine")
    assert run(["simulate", str(cell), *FEW]) == 2
    assert "did not write, and which it would replace" in capsys.readouterr().err
    assert (tmp_path / "recording" / "nw" / "123.png").read_bytes() == b"mine"


def test_ctrl_c_keeps_the_moments_that_are_whole(cell, monkeypatch, capsys):
    from elbowroom.cli import simulate_run

    def interrupted(cameras, moment, **given):
        if moment.time_s > 100.15:
            signal.raise_signal(signal.SIGINT)
        return sensor.render(cameras, moment, **given)

    monkeypatch.setattr(simulate_run, "render", interrupted)
    assert run(["simulate", str(cell), "--moments", "9", "--joints", POSE]) == 0
    # the moment that is being rendered is rendered whole
    assert "3 moments of the 9 that were asked for" in capsys.readouterr().out
    assert len(list(moments(Site.load(cell)))) == 3


def test_ctrl_c_before_the_first_moment_leaves_all_as_it_was(cell, monkeypatch, tmp_path):
    from elbowroom.cli import simulate_run

    assert run(["simulate", str(cell), *FEW]) == 0
    before = sorted(path.name for path in (tmp_path / "recording" / "nw").iterdir())

    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(simulate_run, "render", interrupted)
    assert run(["simulate", str(cell), *FEW]) == 130
    assert sorted(path.name for path in (tmp_path / "recording" / "nw").iterdir()) == before
    assert not list(tmp_path.glob(".recording*"))


def test_the_simulated_room_becomes_a_recording(tmp_path):
    path = tmp_path / "room.yaml"
    path.write_text(
        "grid: {origin_m: [-2, -2, 0], upper_m: [2, 2, 2.5], voxel_size_m: 0.2}\n"
        "simulated: {cameras: 3, resolution: 40x30}\nmachine: {builtin: ceiling_c_arm}\n"
        "joints: {long: {max_speed_m_s: 0.15, braking_time_s: 0.5}}\n"
    )
    out = tmp_path / "out"
    assert run(["simulate", str(path), "--moments", "2", "--rate", "2", "--out", str(out)]) == 0
    site = Site.load(out / "site.yaml")
    first, second = moments(site)
    assert len(first.frames) == 3 and site.simulated is None
    assert first.joints["long"] != second.joints["long"]


@pytest.mark.parametrize(
    ("changes", "options", "words"),
    [
        ({"room": None}, [], "room: missing; give --room"),
        ({"recording": None}, [], "--out: missing; name a folder"),
        ({}, ["--noise", "tof"], "change it there, or give --out"),
        ({}, ["--cameras", "4"], "--cameras: with SITE, it is the site's"),
        ({}, ["--moving", "dog"], "'dog' does not move here"),
        ({}, ["--joints", "hip=0.1"], "hip"),
        ({}, ["--moving", "person"] * 12, "--moving: no way for 12"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path, capsys, changes, options, words):
    path = table_cell(tmp_path, **changes)
    assert run(["simulate", str(path), "--moments", "1", *options]) == 2
    assert words in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "recording").exists()
