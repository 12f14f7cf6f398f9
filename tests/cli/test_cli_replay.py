"""`monitor --record`, `replay`, `export`: a small run from its beginning to images, and back as a bag."""

import json
from pathlib import Path

import pytest

from elbowroom.cli import run
from reference.small_room import SMALL_ROOM


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run of the monitor: run.mcap, and stops/."""
    folder = tmp_path_factory.mktemp("kept")
    (folder / "room.yaml").write_text(SMALL_ROOM)
    words = ["--record", str(folder / "run.mcap"), "--black-box", str(folder / "stops")]
    assert run(["monitor", str(folder / "room.yaml"), "--seconds", "1.5", *words]) == 0
    return folder


def test_a_run_is_replayed_and_is_identical(kept, tmp_path, capsys):
    assert (
        run(["replay", str(kept / "run.mcap"), "--threads", "1", "--json", str(tmp_path / "out.json")]) == 0
    )
    text = capsys.readouterr().out
    assert "identical: " in text and "Every byte is as it was written" in text and "small room" in text
    *cycles, file = json.loads((tmp_path / "out.json").read_text())["rows"]
    assert all(row["identical"] for row in cycles)
    assert file["wrong"] is None and file["note"] is None and len(file["sum"]) == 64


def test_replay_begins_where_it_is_told_to(kept, tmp_path, capsys):
    assert run(["replay", str(kept / "run.mcap"), "--from", "3", "--json", str(tmp_path / "out.json")]) == 0
    rows = json.loads((tmp_path / "out.json").read_text())["rows"]
    assert rows[0]["sequence"] == 3


def test_one_bit_that_is_another_is_said_and_ends_with_1(kept, tmp_path, capsys):
    content = bytearray((kept / "run.mcap").read_bytes())
    content[len(content) // 2] ^= 4
    (tmp_path / "run.mcap").write_bytes(content)
    assert run(["replay", str(tmp_path / "run.mcap")]) == 1
    told = capsys.readouterr()
    assert "not as they were written" in told.out + told.err or "damaged" in (told.out + told.err).lower()


def test_a_file_that_was_cut_off_is_replayed_up_to_there(kept, tmp_path, capsys):
    content = (kept / "run.mcap").read_bytes()
    (tmp_path / "run.mcap").write_bytes(content[: len(content) * 2 // 3])
    assert run(["replay", str(tmp_path / "run.mcap")]) == 0
    text = capsys.readouterr().out
    assert "cut off" in text.lower() and "identical: " in text


def test_why_says_link_place_cause_and_what_would_change_it(kept, tmp_path, capsys):
    words = ["replay", str(kept / "run.mcap"), "--why", "2", "--json", str(tmp_path / "out.json")]
    assert run(words) == 0
    text = capsys.readouterr().out
    rows = json.loads((tmp_path / "out.json").read_text())["rows"]
    assert len(rows) == 4
    for row in rows:
        assert f"{row['joint']} {row['direction']}: " in text
        assert row["level"] == "clear" or row["cause"] == "none" or row["advice"] or row["link"]
    assert run(["replay", str(kept / "run.mcap"), "--why", "99999"]) == 2
    assert "cycle 99999 is not there" in capsys.readouterr().err


def test_export_writes_images_that_are_a_recording(kept, tmp_path, capsys):
    assert run(["export", str(kept / "run.mcap"), str(tmp_path / "out")]) == 0
    text = capsys.readouterr().out
    assert "cam00: " in text and "0.0002 m a unit" in text
    assert (tmp_path / "out" / "site_as_recorded.yaml").read_text() == SMALL_ROOM
    assert run(["export", str(kept / "run.mcap"), str(tmp_path / "out")]) == 2
    assert "holds files already" in capsys.readouterr().err


def test_a_recording_is_a_bag_that_the_monitor_plays(kept, tmp_path, capsys):
    site = tmp_path / "again.yaml"
    assert run(["site", "from-bag", str(kept / "run.mcap"), "--out", str(site)]) == 0
    text = capsys.readouterr().out
    assert "32FC1 as elbowroom, 48x36" in text and "quantised" not in text and "optical axes" not in text
    assert run(["monitor", str(site), "--seconds", "0.3", "--voxel-size", "0.2"]) == 0
    assert "5 cameras" in capsys.readouterr().out


def test_another_file_is_refused_in_a_line(tmp_path, capsys):
    (tmp_path / "other.mcap").write_bytes(b"something else")
    for words in (
        ["replay", str(tmp_path / "other.mcap")],
        ["export", str(tmp_path / "other.mcap"), str(tmp_path / "x")],
    ):
        assert run(words) == 2
        assert "not a recording of `elbowroom monitor`" in " ".join(capsys.readouterr().err.split())


def test_a_file_that_is_there_is_not_written_over(kept, capsys):
    words = ["monitor", str(kept / "room.yaml"), "--seconds", "0", "--record", str(kept / "run.mcap")]
    assert run(words) == 2
    assert "is there already" in " ".join(capsys.readouterr().err.split())


def test_a_site_may_name_the_black_box_but_has_to_say_where(kept, tmp_path, capsys):
    site = tmp_path / "room.yaml"
    site.write_text(SMALL_ROOM + "black_box: {before_s: 5}\n")
    assert run(["monitor", str(site), "--seconds", "0"]) == 2
    assert "write black_box.folder" in " ".join(capsys.readouterr().err.split())
    site.write_text(SMALL_ROOM + "black_box: {folder: stops, after_s: 0}\n")
    assert run(["site", "check", str(site)]) == 2
    assert "black_box.after_s" in capsys.readouterr().err
