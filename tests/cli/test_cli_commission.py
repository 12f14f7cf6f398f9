"""A room is commissioned, a camera is knocked, and the monitor stops and says which."""

import json
from pathlib import Path

import numpy as np
import pytest

from elbowroom.cli import run
from elbowroom.monitor import load_references
from elbowroom.site import Site
from reference.table_cell import POSE, table_cell

SMALL_ROOM = """# a comment that stays
name: small room
grid: {origin_m: [-2, -2, 0], upper_m: [2, 2, 2.5], voxel_size_m: 0.2}
simulated: {cameras: 3, resolution: 64x48, seed: 3}
machine: {builtin: ceiling_c_arm}
joints:
  larm: {max_speed_deg_s: 12, braking_time_s: 0.5}
"""


@pytest.fixture(scope="module")
def commissioned(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("commissioned")
    (folder / "room.yaml").write_text(SMALL_ROOM)
    assert run(["calibrate", "commission", str(folder / "room.yaml"), "--out", str(folder / "watched.yaml"),
                "--frames", "8", "--json", str(folder / "commission.json")]) == 0  # fmt: skip
    return folder / "watched.yaml"


def rows(path: Path, kind: str) -> list[dict]:
    return [row for row in json.loads(path.read_text())["rows"] if row["kind"] == kind]


def test_the_new_site_names_the_reference_and_keeps_its_words(commissioned):
    text = commissioned.read_text()
    assert "# a comment that stays" in text
    site = Site.load(commissioned)
    assert site.entry.watch.reference == "watched.watch.npz"
    references = load_references(site.entry.watch.reference_path(commissioned.parent))
    assert [reference.camera for reference in references] == ["cam00", "cam01", "cam02"]
    told = rows(commissioned.with_name("commission.json"), "reference")
    assert [row["camera"] for row in told] == ["cam00", "cam01", "cam02"]
    assert all(row["spots"] >= 60 and np.isfinite(row["turn_sigma_deg"]).all() for row in told)


def test_a_site_is_commissioned_again_with_one_key(commissioned, tmp_path):
    again = commissioned.with_name("again.yaml")
    commissioned.write_text(commissioned.read_text() + "  turn_deg: 0.7\n")
    assert run(["calibrate", "commission", str(commissioned), "--out", str(again), "--frames", "5"]) == 0
    watch = Site.load(again).entry.watch
    assert (watch.reference, watch.turn_deg) == ("again.watch.npz", 0.7)
    assert again.read_text().count("watch:") == 1


def test_a_knocked_camera_stops_the_monitor_and_is_named(commissioned, tmp_path, capsys):
    out = tmp_path / "run.json"
    assert (
        run(["monitor", str(commissioned), "--seconds", "5", "--knock", "cam01:2deg@0", "--json", str(out)])
        == 0
    )
    (summary,) = rows(out, "summary")
    (reason,) = summary["stop_reasons"]
    assert reason.startswith("camera cam01 has turned by") and summary["watched"]
    stopped = [row for row in rows(out, "cycle") if row["stopped_by"]]
    assert stopped and stopped[-1]["stopped_by"] == reason and stopped[-1]["fault"] is None
    sequence = stopped[-1]["sequence"]
    assert all(row["level"] == "stop" for row in rows(out, "verdict") if row["sequence"] == sequence)
    assert any(row["stop"] == reason for row in rows(out, "health") if row.get("camera") == "cam01")
    assert reason in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--knock", "cam09:1deg@5"], "--knock: nothing is called 'cam09'"),
        (["--knock", "cam01"], "--knock: 'cam01' is no knock"),
        (["--cameras", "2"], "which the site has not"),
        (["--resolution", "32x24"], "commission again"),
    ],
)
def test_what_does_not_fit_the_watch_is_one_line(commissioned, arguments, said, capsys):
    assert run(["monitor", str(commissioned), "--seconds", "1", *arguments]) != 0
    error = capsys.readouterr().err.strip()
    assert said in error and len(error.splitlines()) == 1


def test_a_reference_that_is_absent_or_damaged_is_one_line(commissioned, tmp_path, capsys):
    site = tmp_path / "site.yaml"
    site.write_text(commissioned.read_text())
    assert run(["monitor", str(site), "--seconds", "1"]) != 0
    assert "watch.reference: no file" in capsys.readouterr().err
    (tmp_path / "watched.watch.npz").write_bytes(b"not a reference")
    assert run(["monitor", str(site), "--seconds", "1"]) != 0
    assert "watched.watch.npz: no reference" in capsys.readouterr().err


def test_the_site_itself_is_never_overwritten_nor_written_where_its_paths_break(
    commissioned, tmp_path, capsys
):
    for out, said in ((commissioned, "the site file itself"), (tmp_path / "x.yaml", "another folder")):
        assert run(["calibrate", "commission", str(commissioned), "--out", str(out), "--frames", "5"]) != 0
        assert said in capsys.readouterr().err
    assert not (tmp_path / "x.yaml").exists() and not (tmp_path / "x.watch.npz").exists()


def test_images_that_cannot_be_meant_so_are_not_commissioned_and_are_written_aside_by_force(tmp_path, capsys):
    cell = table_cell(tmp_path)
    assert run(["simulate", str(cell), "--moments", "5", "--still", "--joints", POSE]) == 0
    cell.write_text(cell.read_text().replace("depth_scale_m: 0.001", "depth_scale_m: 0.004"))
    new, joints = tmp_path / "watched.yaml", ["--joints", POSE]
    assert run(["calibrate", "commission", str(cell), "--out", str(new), *joints]) == 1
    error = capsys.readouterr().err.splitlines()[-1]
    assert "this is no result" in error and "Most likely the unit of depth" in error
    assert not list(tmp_path.glob("watched*"))
    assert run(["calibrate", "commission", str(cell), "--out", str(new), "--force-file", *joints]) == 1
    assert sorted(path.name for path in tmp_path.glob("watched*")) == [
        "watched.doubted.watch.npz",
        "watched.doubted.yaml",
    ]
