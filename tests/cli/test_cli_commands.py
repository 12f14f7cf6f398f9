"""The commands from end to end, on a small simulated room and on a recording of it."""

import json
import signal
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from elbowroom.cli import run
from elbowroom.simulate import InterventionRoom, render, wall_cameras
from elbowroom.site import Site
from reference.small_room import SMALL_ROOM

VERDICT_KEYS = {"joint", "direction", "level", "band", "free_travel", "free_travel_unit", "cause", "link"}


@pytest.fixture
def room(tmp_path) -> Path:
    path = tmp_path / "room.yaml"
    path.write_text(SMALL_ROOM)
    return path


@pytest.fixture
def recording(tmp_path) -> Path:
    """Two moments of the small room, half a second apart, as a folder with stamps and joints."""
    cameras = wall_cameras(3, width=48, height=36)
    room = InterventionRoom()
    lines = ["stamp_ns,long,larm,propeller,carc"]
    for time_s in (1.0, 1.5):
        moment = room.at(time_s)
        lines.append(",".join(map(str, [moment.stamp_ns, *moment.joints.values()])))
        for frame in render(cameras, moment):
            folder = tmp_path / "recorded" / frame.camera
            folder.mkdir(parents=True, exist_ok=True)
            millimetres = np.clip(np.nan_to_num(frame.depth_m) * 1000, 0, 65535).astype(np.uint16)
            Image.fromarray(millimetres).save(folder / f"{frame.stamp_ns}.png")
    (tmp_path / "recorded" / "joints.csv").write_text("\n".join(lines) + "\n")
    entries = [
        {
            "name": camera.name,
            "width": camera.width,
            "height": camera.height,
            "fx": camera.intrinsics.fx,
            "fy": camera.intrinsics.fy,
            "cx": camera.intrinsics.cx,
            "cy": camera.intrinsics.cy,
            "world_from_camera": camera.world_from_camera.tolist(),
        }
        for camera in cameras
    ]
    parts = [
        SMALL_ROOM.replace("simulated: {cameras: 5, resolution: 48x36, seed: 3}\n", ""),
        f"cameras: {json.dumps(entries)}",
        "recording: {layout: folder, folder: recorded}",
    ]
    path = tmp_path / "recording.yaml"
    path.write_text("\n".join(parts))
    return path


def rows_of(path: Path) -> list[dict]:
    return json.loads(path.read_text())["rows"]


def test_monitor_writes_cycles_verdicts_and_pictures(room, tmp_path, capsys):
    out, pictures = tmp_path / "out.json", tmp_path / "pictures"
    assert run(["monitor", str(room), "--seconds", "0.3", "--json", str(out), "--out", str(pictures)]) == 0
    text = capsys.readouterr().out
    assert "first frames" in text and "Not a certified safety function" in text
    assert "Not checked, by the site's word: rail, carriage" in text
    rows = rows_of(out)
    kinds = [row["kind"] for row in rows]
    assert kinds[0] == "room" and kinds[-1] == "summary"
    cycles = [row for row in rows if row["kind"] == "cycle"]
    verdicts = [row for row in rows if row["kind"] == "verdict"]
    assert len(verdicts) == 4 * len(cycles) > 0
    assert all(row["fault"] is None and row["cycle_ms"] > 0 for row in cycles)
    assert all(abs(sum(row["stage_ms"].values()) - row["cycle_ms"]) < 1e-6 for row in cycles)
    assert all(set(row) >= VERDICT_KEYS for row in verdicts)
    assert {row["free_travel_unit"] for row in verdicts} == {"m", "rad"}
    assert {row["direction"] for row in verdicts} == {"+", "-"}
    assert rows[-1]["cycles"] == len(cycles) and rows[-1]["faults"] == 0
    assert len(list(pictures.glob("*.png"))) == 5


def test_monitor_plays_a_recording_once(recording, tmp_path):
    out = tmp_path / "out.json"
    assert run(["monitor", str(recording), "--json", str(out)]) == 0
    assert [row["time_s"] for row in rows_of(out) if row["kind"] == "cycle"] == [1.0, 1.5]


@pytest.mark.parametrize(
    "option", [["--cameras", "3"], ["--resolution", "64x48"], ["--knock", "cam00:1deg@5"]]
)
def test_a_recording_has_the_cameras_that_it_has(recording, capsys, option):
    assert run(["monitor", str(recording), *option]) == 2
    assert f"elbowroom: {option[0]}: for simulated rooms" in capsys.readouterr().err


def test_what_the_library_says_of_an_argument_names_the_option(recording, capsys):
    (recording.parent / "recorded" / "joints.csv").unlink()
    site = recording.read_text().replace("layout: folder", "layout: stampless")
    recording.write_text(site)
    assert run(["monitor", str(recording)]) == 2
    assert f"elbowroom: --joints: {recording} records none of its machine" in capsys.readouterr().err
    recording.write_text(site[: site.index("machine:")] + site[site.index("cameras:") :])
    assert run(["check", str(recording), "--joint", "larm", "--direction", "+", "--joints", "larm=0"]) == 2
    assert f"elbowroom: --joints: {recording} names no machine" in capsys.readouterr().err


def test_ctrl_c_ends_the_monitor_with_its_summary(room, tmp_path, capsys, monkeypatch):
    from elbowroom.view.screen.terminal import TerminalView

    def interrupted(self, done):
        self.log.add(done.result, done.source_ms)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(TerminalView, "show", interrupted)
    out = tmp_path / "out.json"
    assert run(["monitor", str(room), "--json", str(out)]) == 0
    assert "1 cycles in" in capsys.readouterr().out
    assert rows_of(out)[-1]["cycles"] == 1


@pytest.mark.parametrize(
    ("end", "words"), [("machine:", "no machine: no motion is judged"), ("joints:", "no joint of")]
)
def test_where_no_motion_can_be_asked_monitor_says_what_is_free(room, tmp_path, capsys, end, words):
    room.write_text(SMALL_ROOM[: SMALL_ROOM.index(end)])
    out = tmp_path / "out.json"
    assert run(["monitor", str(room), "--seconds", "0.2", "--json", str(out), "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert words in text and "% of the watched box" in text and "movement" not in text
    rows = rows_of(out)
    assert not [row for row in rows if row["kind"] == "verdict"]
    for row in (row for row in rows if row["kind"] == "cycle"):
        assert row["level"] == "stop" and row["fault"] is None
        assert row["free_pct"] + row["surface_pct"] + row["unseen_pct"] == pytest.approx(100)
    assert list(tmp_path.glob("*.png"))


def test_the_noise_and_size_of_a_simulated_rooms_cameras_are_the_runs(room, capsys):
    argv = ["monitor", str(room), "--noise", "tof", "--resolution", "40x30", "--seconds", "0"]
    assert run(argv) == 0
    assert "5 cameras 40x30" in capsys.readouterr().out
    assert run([*argv[:3], "sonar", "--seconds", "0"]) == 2
    assert "--noise: 'sonar' is unknown, allowed are exact," in capsys.readouterr().err


def test_noise_of_real_cameras_is_the_sites_to_say(recording, capsys):
    assert run(["monitor", str(recording), "--noise", "tof"]) == 2
    assert "--noise: for simulated rooms" in capsys.readouterr().err


def test_reconstruct_writes_arrays_points_and_pictures(recording, tmp_path, capsys):
    out, result = tmp_path / "out.json", tmp_path / "result"
    argv = ["reconstruct", str(recording), "--out", str(result), "--json", str(out), "--voxel-size", "0.25"]
    assert run([*argv, "--rule", "any", "--moment", "1"]) == 0
    (row,) = rows_of(out)
    assert (row["voxel_size_m"], row["shape"], row["rule"], row["moment"]) == (0.25, [16, 16, 10], "any", 1)
    assert row["frames"] == row["cameras"] == 3 and row["time_s"] == 1.5
    assert row["free_pct"] + row["surface_pct"] + row["unseen_pct"] == pytest.approx(100)
    with np.load(result / "free_space.npz", allow_pickle=False) as file:
        assert 100 * file["free"].mean() == pytest.approx(row["free_pct"])
    assert sorted(path.name for path in result.iterdir()) == sorted(Path(name).name for name in row["files"])
    assert f"{row['free_pct']:.2f} %" in capsys.readouterr().out


def test_a_moment_that_is_not_there_is_named_and_leaves_no_file(recording, tmp_path, capsys):
    out = tmp_path / "out.json"
    argv = ["reconstruct", str(recording), "--out", str(tmp_path / "r"), "--moment", "2", "--json", str(out)]
    assert run(argv) == 2
    error = capsys.readouterr().err
    assert "--moment: 2 is not there" in error and "has 2 moments, from 0" in error
    assert not out.exists() and list((tmp_path / "r").iterdir()) == []


def test_check_says_the_verdict_in_words(recording, tmp_path, capsys):
    out = tmp_path / "out.json"
    argv = ["check", str(recording), "--joint", "larm", "--direction", "-", "--json", str(out)]
    assert run([*argv, "--joints", "long=0,larm=10deg,propeller=0,carc=0"]) == 0
    (row,) = rows_of(out)
    assert (row["joint"], row["direction"]) == ("larm", "-") and set(row) >= VERDICT_KEYS
    text = capsys.readouterr().out
    assert text.startswith("larm -: ") and "Free travel: " in text and "rail, carriage" in text
    if row["place_m"] is not None:
        assert row["link"] in text and "cam0" in text


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["--joint", "elbow", "--direction", "+"], "no joint 'elbow'; joints are long, larm"),
        (["--joint", "carc", "--direction", "+"], "joints with a speed are long, larm"),
        (["--joint", "larm", "--direction", "+", "--joints", "larm=1"], "'long' has no position"),
        (
            ["--joint", "larm", "--direction", "+", "--joints", "long=9,larm=1,propeller=0,carc=0"],
            "out of its limits",
        ),
    ],
)
def test_check_names_what_is_wrong(room, capsys, argv, words):
    assert run(["check", str(room), *argv]) == 2
    assert words in capsys.readouterr().err


def test_the_simulated_room_is_the_default():
    assert Site.simulated_room().simulated is not None
