"""The commands from end to end, on a small room."""

import json
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from elbowroom.cli import run
from elbowroom.placement.fixed_room import FixedRoom
from elbowroom.placement.verification import verify
from elbowroom.site import Site
from elbowroom.site.site import THESIS_ROOM
from elbowroom.sources import cameras_of

SMALL = """
name: hall
grid: {origin_m: [-2, -2, 0], upper_m: [2, 2, 2.5], voxel_size_m: 0.25}
camera_defaults: {width: 64, height: 48, fx: 32.0, fy: 32.0, cx: 31.5, cy: 23.5}
room:
  walls: {lower_m: [-2.5, -2.5, 0.0], upper_m: [2.5, 2.5, 2.9]}
  furniture: [{name: cupboard, lower_m: [1.5, 1.5, 0.0], upper_m: [2.5, 2.5, 1.8]}]
placement:
  mounts_along: {wall_spacing_m: 1.25, heights_m: [2.4]}
  aims_m: [[0.0, 0.0, 0.5], [0.0, 0.0, 1.0]]
"""


@pytest.fixture
def empty(tmp_path):
    path = tmp_path / "hall.yaml"
    path.write_text(SMALL)
    return path


@pytest.fixture
def placed(empty):
    path = empty.with_name("placed.yaml")
    entries = [
        {"name": f"c{n}", "position_m": [x, y, 2.4], "look_at_m": [0.0, 0.0, 0.8]}
        for n, (x, y) in enumerate([(2.4, 0.1), (0.1, 2.4), (-2.4, 0.1), (0.1, -2.4), (-2.3, -2.3)])
    ]
    path.write_text(SMALL + f"cameras: {json.dumps(entries)}\n")
    return path


def rows(path):
    written = json.loads(path.read_text())
    assert {"command", "commit", "processor", "versions"} <= written["meta"].keys()
    return written["rows"]


def test_verify_says_shares_and_worst_places_and_draws(placed, tmp_path, capsys):
    out, pictures = tmp_path / "out.json", tmp_path / "pictures"
    assert (
        run(["placement", "verify", str(placed), "--json", str(out), "--out", str(pictures), "--worst", "3"])
        == 0
    )
    (row,) = rows(out)
    site = Site.load(placed)
    found = verify(site.grid(), cameras_of(site), FixedRoom.of_site(site))
    assert row["valid_pct"] == pytest.approx(found.valid_pct) and row["cameras"] == 5
    assert 0 < row["valid_pct"] < row["seen_by_views_pct"] <= row["seen_by_one_pct"] <= 100
    assert len(row["worst"]) == 3 and row["seconds"] > 0
    said = capsys.readouterr().out
    assert f"valid     {found.valid_pct:.2f} %" in said and "worst     x" in said
    assert sorted(p.name for p in pictures.iterdir()) == sorted(
        ["plan.png", "views_z.png", "valid_z.png", "views_x.png", "valid_x.png"]
    )
    with Image.open(pictures / "plan.png") as plan:
        colours = {tuple(c) for c in np.asarray(plan.convert("RGB")).reshape(-1, 3)[::7]}
    assert {(126, 131, 138), (0, 158, 115)} & colours


def test_views_and_angle_are_options(placed, tmp_path):
    shares = []
    for options in (["--views", "1", "--angle", "0"], ["--views", "2", "--angle", "90"], ["--views", "3"]):
        out = tmp_path / "out.json"
        assert run(["placement", "verify", str(placed), "--json", str(out), *options]) == 0
        shares.append(rows(out)[0]["valid_pct"])
    assert shares[0] >= shares[1] >= shares[2] and shares[0] > 99


def test_a_site_without_walls_says_that_nothing_blocks(placed, capsys):
    text = placed.read_text()
    placed.write_text(text[: text.index("room:")] + text[text.index("cameras: [{") :])
    assert run(["placement", "verify", str(placed)]) == 0
    assert "note      the site has no key room" in capsys.readouterr().out


def test_sweep_names_the_smallest_number(tmp_path, capsys):
    out = tmp_path / "out.json"
    words = [
        "placement",
        "sweep",
        "--cameras",
        "9-12",
        "--voxel-size",
        "0.5",
        "--sensor",
        "thesis",
        "--aim",
        "0.4",
    ]
    assert run([*words, "--share", "85", "--walls", "5", "--out", str(tmp_path), "--json", str(out)]) == 0
    *layouts, summary = rows(out)
    assert [row["cameras"] for row in layouts] == [9, 10, 11, 12]
    least = next(row["cameras"] for row in layouts if row["valid_pct"] >= 85)
    assert summary["least_cameras"] == least and summary["layouts"] == 4
    assert "walls 5 m" in capsys.readouterr().out and (tmp_path / "sweep.png").exists()


def test_optimise_writes_a_site_that_verify_judges_the_same(empty, tmp_path, capsys):
    pytest.importorskip("ortools")
    out, written = tmp_path / "out.json", tmp_path / "written.yaml"
    words = ["placement", "optimise", str(empty), "--share", "70", "--seconds", "2", "--points", "300"]
    assert run([*words, "--write", str(written), "--json", str(out)]) == 0
    layout, *rest = rows(out)
    assert {"valid_pct", "cameras", "bound", "seconds"} <= layout.keys()
    assert layout["valid_pct"] >= 70 and 3 <= layout["bound"] <= layout["cameras"]
    assert {row["kind"] for row in rest} == {"item", "total", "step"}
    said = capsys.readouterr().out
    assert "bound     no layout of these candidates" in said and f"site      {written}" in said
    assert run(["placement", "verify", str(written), "--json", str(out)]) == 0
    assert rows(out)[0]["valid_pct"] == pytest.approx(layout["valid_pct"])
    assert (
        run(
            [
                "placement",
                "optimise",
                str(written),
                "--keep",
                "--cameras",
                "9",
                "--seconds",
                "1",
                "--points",
                "200",
            ]
        )
        == 0
    )
    assert f"{layout['cameras']} of them there already" in capsys.readouterr().out


def test_monitor_runs_a_layout_of_the_simulated_room(tmp_path):
    pytest.importorskip("ortools")
    text = (
        Site.simulated_room()
        .path.read_text()
        .replace("voxel_size_m: 0.05", "voxel_size_m: 0.25")
        .replace("160x120", "48x36")
    )
    (tmp_path / "room.yaml").write_text(text)
    written = str(tmp_path / "placed.yaml")
    words = [
        "placement",
        "optimise",
        str(tmp_path / "room.yaml"),
        "--cameras",
        "5",
        "--seconds",
        "1",
        "--points",
        "200",
    ]
    assert run([*words, "--write", written]) == 0
    assert run(["monitor", written, "--seconds", "0.3", "--json", str(tmp_path / "m.json")]) == 0
    assert rows(tmp_path / "m.json")[-1]["kind"] == "summary"
    assert run(["site", "check", written]) == 0


def test_simulate_says_what_is_found_and_what_each_camera_is_worth(placed, tmp_path, capsys):
    out = tmp_path / "out.json"
    assert (
        run(["placement", "simulate", str(placed), "--scenes", "2", "--people", "1", "--json", str(out)]) == 0
    )
    summary, *cameras = rows(out)
    assert summary["scenes"] == 2 and 0 < summary["free_pct"] < 100
    assert [row["camera"] for row in cameras] == [f"c{n}" for n in range(5)]
    said = capsys.readouterr().out
    assert "found     " in said and "lost if it fails" in said


def test_capability_writes_pictures_and_arrays(placed, tmp_path, capsys):
    out = tmp_path / "maps"
    assert (
        run(
            [
                "placement",
                "capability",
                str(placed),
                "--views",
                "2",
                "--out",
                str(out),
                "--json",
                str(tmp_path / "c.json"),
            ]
        )
        == 0
    )
    (row,) = rows(tmp_path / "c.json")
    assert row["views"] == 2 and row["smallest_mm"]["50_pct"] <= row["smallest_mm"]["99_pct"]
    assert {p.name for p in out.iterdir()} == {"capability.npz", "capability_x.png", "capability_z.png"}
    assert "ISO 13855 C" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["verify", str(THESIS_ROOM)], "cameras: none yet; `elbowroom placement optimise`"),
        (["verify", "none.yaml"], "no such file"),
        (["verify", "PLACED", "--views", "4"], "4 views each 100 degrees apart do not fit on a circle"),
        (["verify", "PLACED", "--voxel-size", "nan"], "voxel_size_m is nan"),
        (["sweep", "--cameras", "40-3"], "write FROM-TO"),
        (["sweep", "--share", "0"], "--share: 0 %"),
        (["sweep", "--sensor", "lidar"], "'lidar' is unknown, there are thesis, vga, square"),
        (["sweep", "--walls", "-1"], "--walls: -1 m"),
        (["optimise", "PLACED", "--share", "100", "--points", "300"], "100 % is out of reach"),
        (["optimise", "PLACED", "--cameras", "4", "--keep"], "4 cameras wanted, 5 hang there already"),
        (["optimise", "PLACED", "--seconds", "0"], "--seconds: 0"),
        (["optimise", "PLACED", "--seconds", "nan"], "--seconds: nan"),
        (["capability", "PLACED", "--views", "9"], "9 views, there are 5 cameras"),
    ],
)
def test_what_is_wrong_is_one_line(placed, capsys, words, told):
    assert run(["placement", *(str(placed) if word == "PLACED" else word for word in words)]) == 2
    line = capsys.readouterr().err.strip().splitlines()[-1]
    assert line.startswith("elbowroom: ") and told in line


def test_a_camera_in_the_cupboard_is_one_line(placed, capsys):
    placed.write_text(placed.read_text().replace("[2.4, 0.1, 2.4]", "[2.0, 2.0, 1.0]"))
    assert run(["placement", "verify", str(placed)]) == 2
    assert "camera c0: at [2.0, 2.0, 1.0] m it is inside cupboard" in capsys.readouterr().err


def test_placement_is_there_without_ortools():
    code = "import sys; sys.modules['ortools'] = None; import elbowroom.cli.placement.optimise, elbowroom.placement"
    subprocess.run([sys.executable, "-c", code], check=True)
