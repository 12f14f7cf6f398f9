"""`elbowroom simulate`: from a GLB to a recording that the other commands read."""

import json

import numpy as np
import pytest
import trimesh

from elbowroom.cli import run
from elbowroom.machine.c_arm import ceiling_c_arm
from elbowroom.simulate import render, setup
from elbowroom.site import Site
from elbowroom.sources import moments
from elbowroom.sources.recorder import UNIT_M, as_units

FEW = ["--size", "thesis", "--cameras", "5", "--height", "1.9"]


def a_room(path, name="box", scale=1.0):
    scene = trimesh.Scene()
    floor = trimesh.creation.box(bounds=np.array([(-3, -0.2, -3), (3, 0.05, 3)]) * scale)
    scene.add_geometry(floor, node_name=name, geom_name=name)
    path.write_bytes(scene.export(file_type="glb"))
    return path


def test_what_is_read_back_is_never_farther_than_what_was_rendered(tmp_path):
    out = tmp_path / "room"
    assert (
        run(["simulate", "--room", "setup6", "--out", str(out), *FEW, "--json", str(tmp_path / "a.json")])
        == 0
    )
    site = Site.load(out / "site.yaml")
    (moment,) = moments(site)
    assert moment.joints == pytest.approx(dict(setup(6).joints))
    exact = {f.camera: f for f in render(site.cameras(), setup(6).at(ceiling_c_arm()), noise=False)}
    for frame in moment.frames:
        behind = exact[frame.camera].depth_m - frame.depth_m
        assert behind.min() >= -2e-6 and behind.max() <= UNIT_M + 2e-6
    (row,) = json.loads((tmp_path / "a.json").read_text())["rows"]
    assert row["objects"] == len(setup(6).solids())
    assert (out / "colour.png").is_file() and (out / "depth.png").is_file()


def test_the_recording_is_reconstructed(tmp_path, capsys):
    out = tmp_path / "room"
    assert run(["simulate", "--room", "setup1", "--out", str(out), *FEW, "--voxel-size", "0.1"]) == 0
    assert run(["reconstruct", str(out / "site.yaml"), "--out", str(tmp_path / "result")]) == 0
    assert "free" in capsys.readouterr().out


def test_a_users_room_without_a_machine(tmp_path):
    room = a_room(tmp_path / "my.glb")
    out = tmp_path / "out"
    argv = ["simulate", "--room", str(room), "--no-machine", "--box", "-1,-2,0,1,2,2"]
    assert run([*argv, "--out", str(out), *FEW]) == 0
    site = Site.load(out / "site.yaml")
    assert site.machine() is None
    centres = np.array([camera.centre_in_world for camera in site.cameras()])
    assert np.abs(centres[:, 0]).max() <= 1 and np.abs(centres[:, 1]).max() > 1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--box", "1,2"], "six numbers"),
        (["--noise", "sonar"], "'sonar' is unknown"),
        (["--box", "10,10,10,12,12,12"], "no object reaches into the box"),
        (["--no-machine", "--joints", "long=0.1"], "without a machine"),
        (["--joints", "elbow=0.1"], "elbow"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path, capsys, options, words):
    room = a_room(tmp_path / "my.glb")
    assert run(["simulate", "--room", str(room), "--out", str(tmp_path / "out"), *FEW, *options]) == 2
    err = capsys.readouterr().err
    assert words in err.splitlines()[-1]


def test_a_room_in_millimetres_is_one_line_that_names_the_object(tmp_path, capsys):
    room = a_room(tmp_path / "mm.glb", name="floor of the lab", scale=1000)
    assert run(["simulate", "--room", str(room), "--out", str(tmp_path / "out"), *FEW]) == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert "floor of the lab" in last and "0.001" in last


def test_units_are_rounded_down_and_what_is_too_far_is_no_return():
    depth = np.array([[0.0, UNIT_M * 2.9, 50.0, np.nan, np.inf, UNIT_M * 3]])
    assert as_units(depth).tolist() == [[0, 2, 0, 0, 0, 3]]
