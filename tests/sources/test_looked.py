"""What is found in a site's files: the recordings of users' troubles, made here."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from PIL import Image

from elbowroom.cli import run
from elbowroom.site import Site
from elbowroom.sources import looked_at
from reference import values_room as room


def site_of(tmp_path, scene, **more):
    """A site file and its images."""
    for name, raw in scene.codes.items():
        Image.fromarray(raw).save(tmp_path / f"{name}.png")
    k = scene.cameras[0].intrinsics
    content = {
        "grid": {"origin_m": list(scene.grid.origin_m), "shape": list(scene.grid.shape), "voxel_size_m": 0.1},
        "camera_defaults": {
            "width": room.WIDTH,
            "height": room.HEIGHT,
            "fx": k.fx,
            "fy": k.fy,
            "cx": k.cx,
            "cy": k.cy,
            "depth_scale_m": scene.units_m["ne"],
            **more,
        },
        "cameras": [
            {"name": camera.name, "world_from_camera": camera.world_from_camera.tolist()}
            for camera in scene.cameras
        ],
        "recording": {
            "layout": "stampless",
            "folder": ".",
            "files": {name: f"{name}.png" for name in scene.codes},
        },
    }
    (tmp_path / "site.yaml").write_text(yaml.safe_dump(content))
    return tmp_path / "site.yaml"


def kinds(path):
    return {(finding.kind, finding.stops) for finding in looked_at(Site.load(path))}


def test_a_site_as_it_should_be_is_passed_in_silence(tmp_path):
    assert kinds(site_of(tmp_path, room.scene())) == set()


def test_images_of_another_unit_stop_check_and_reconstruct_with_one_line(tmp_path, capsys):
    scene = room.scene(unit_m=0.00025)
    path = site_of(tmp_path, replace(scene, units_m=dict.fromkeys(scene.units_m, 0.001)))
    assert kinds(path) == {("unit", True)}
    assert run(["site", "check", str(path), "--json", str(tmp_path / "rows.json")]) == 1
    said = capsys.readouterr().out
    assert "cannot be meant so" in said and "depth_scale_m 0.00025" in said
    assert '"stops":true' in (tmp_path / "rows.json").read_text()
    assert run(["reconstruct", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "Most likely the unit of depth" in capsys.readouterr().err
    assert not list((tmp_path / "out").glob("*.npz"))


def test_the_greatest_range_written_for_nothing_is_said_and_is_no_surface(tmp_path, capsys):
    scene = room.scene()
    codes = {name: np.where(raw > 3800, 10000, raw).astype(np.uint16) for name, raw in scene.codes.items()}
    assert kinds(site_of(tmp_path, replace(scene, codes=codes))) == {("sentinel", True)}
    path = site_of(tmp_path, replace(scene, codes=codes), max_depth_m=10.0)
    assert kinds(path) == {("at max_depth_m", False)}
    assert run(["site", "check", str(path)]) == 0
    assert "taken as no return" in capsys.readouterr().out


def test_a_part_of_the_image_that_never_returns_is_told_with_the_command_that_masks_it(tmp_path, capsys):
    scene = room.scene()
    path = site_of(tmp_path, scene)
    assert run(["site", "check", str(path)]) == 0 and "never returns" not in capsys.readouterr().out
    codes = {name: raw.copy() for name, raw in scene.codes.items()}
    codes["ne"][: room.HEIGHT // 4] = 0
    path = site_of(tmp_path, replace(scene, codes=codes))
    assert run(["site", "check", str(path)]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "through: ne 25%" in told and f"elbowroom site mask {path}" in told


@pytest.mark.parametrize(("fx", "said"), [(160.0, "principal point"), (0.5, "field of view")])
def test_a_wrong_lens_stops_before_any_image_is_read(tmp_path, fx, said):
    path = site_of(tmp_path, room.scene(), fx=fx, fy=fx, cx=2 * fx - 0.5, cy=1.5 * fx - 0.5)
    for name in room.EYES:
        (tmp_path / f"{name}.png").write_bytes(b"")
    assert kinds(path) == {(said, True)}
