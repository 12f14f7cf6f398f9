"""`elbowroom evaluate` from end to end: few cameras, few pixels, large voxels."""

import json
import sys

import pytest

from elbowroom.cli import run
from elbowroom.errors import InputError
from elbowroom.evaluate.examples import example

COMMANDS = [
    *("room", "sevenscenes", "alone", "poses", "travel", "bits", "thin-solids", "lost-pixels", "placement"),
    *("scale-cameras", "scale-budget", "looks"),
]
SMALL = ["--cameras", "5", "--size", "thesis", "--voxel-size", "0.1"]
ROUNDED = 1.5e-6
"""What two numbers of a file may differ by, each rounded to six digits after the point."""


def rows_of(path):
    return json.loads(path.read_text())["rows"]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_an_example(capsys, command):
    assert run(["evaluate", command, "--help"]) == 0
    text = capsys.readouterr().out
    assert f"elbowroom evaluate {command}" in text.split("Example")[-1]
    assert "--json" in text


def test_room_has_a_row_for_each_detail_and_noise(tmp_path, capsys):
    out = tmp_path / "out.json"
    assert run(["evaluate", "room", *SMALL, "--json", str(out)]) == 0
    rows = rows_of(out)
    assert {(row["detail"], row["noise"]) for row in rows} == {
        (detail, noise) for detail in ("footprint", "pixel", "point") for noise in (False, True)
    }
    for row in rows:
        # the pixel test promises a rate, and these few pixels are coarse for the room's thin things
        due = {"footprint": 100 - 1e-4, "pixel": 99.9, "point": 0}[row["detail"]]
        assert row["occupied_pct"] >= due
        assert 0 < row["found_pct"] <= 100
    assert all(row["voxel_size_m"] == 0.1 for row in rows)
    text = capsys.readouterr().out
    assert "footprint" in text and "Due" in text


def test_sevenscenes_has_a_row_for_each_rule_and_detail(example_site, tmp_path, capsys):
    site, out = example_site("sevenscenes"), tmp_path / "out.json"
    assert run(["evaluate", "sevenscenes", str(site), "--voxel-size", "0.2", "--json", str(out)]) == 0
    rows = rows_of(out)
    assert len({(row["rule"], row["detail"], row["margin"]) for row in rows}) == len(rows) == 24
    by = {(row["rule"], row["detail"], row["margin"]): row["free_pct"] for row in rows}
    assert by["any", "pixel", "site"] >= by["three", "pixel", "site"] > 0
    assert "Due" in capsys.readouterr().out


def test_the_default_recording_is_the_examples(example_site):
    assert example("sevenscenes").samefile(example_site("sevenscenes"))


def test_an_absent_example_is_named(tmp_path):
    with pytest.raises(InputError, match=r"sevenscenes\.yaml: not there; only a checkout"):
        example("sevenscenes", tmp_path)


def test_absent_data_is_named(tmp_path, monkeypatch, capsys):
    out = tmp_path / "out.json"
    monkeypatch.setenv("ELBOWROOM_DATA", str(tmp_path / "nothing"))
    assert run(["evaluate", "sevenscenes", "--json", str(out)]) == 2
    err = capsys.readouterr().err
    assert "nothing" in err and err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_alone_judges_all_motions_at_each_voxel_size(tmp_path, capsys):
    out = tmp_path / "out.json"
    argv = ["evaluate", "alone", "--poses", "2", *SMALL, "--voxel-size", "0.2", "--json", str(out)]
    assert run(argv) == 0
    verdicts = [row for row in rows_of(out) if row["kind"] == "verdict"]
    summaries = [row for row in rows_of(out) if row["kind"] == "summary"]
    assert len(verdicts) == 2 * 2 * 8
    assert {(row["level"], row["band"]) for row in verdicts} <= {
        ("stop", "S"),
        ("decelerate", "M"),
        ("inform", "L"),
        ("clear", "0"),
    }
    assert [row["voxel_size_m"] for row in summaries] == [0.1, 0.2]
    for row in summaries:
        assert row["verdicts"] == row["clear"] + row["inform"] + row["decelerate"] + row["stop"] == 16
    assert "all clear" in capsys.readouterr().out


def test_poses_compares_each_verdict_with_exact_geometry(tmp_path, capsys):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    out = tmp_path / "out.json"
    assert run(["evaluate", "poses", "--poses", "2", *SMALL, "--json", str(out)]) == 0
    *verdicts, summary = rows_of(out)
    assert len(verdicts) == summary["verdicts"] == 16
    assert (summary["voxel_size_m"], summary["detail"], summary["width"]) == (0.1, "pixel", 64)
    # said once, not in each row
    assert (summary["seed"], summary["cameras"], summary["heights_m"]) == (2, 5, [2.4, 0.4])
    assert not any({"seed", "cameras", "width", "heights_m", "joints"} & row.keys() for row in verdicts)
    assert all(row["milder"] == (row["free_travel"] > row["true_travel"] + ROUNDED) for row in verdicts)
    assert summary["milder"] == sum(row["milder"] for row in verdicts) == 0
    assert "milder than exact geometry" in capsys.readouterr().out


def test_travel_in_the_true_volume_is_never_more_than_exact(tmp_path, capsys):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    out = tmp_path / "out.json"
    assert (
        run(["evaluate", "travel", "--poses", "8", "--voxel-size", "0.05", "--seed", "5", "--json", str(out)])
        == 0
    )
    *motions, summary = rows_of(out)
    assert (summary["voxel_size_m"], summary["poses"], summary["motions"]) == (0.05, 8, 64)
    assert summary["more_than_truth"] == 0
    assert all(row["free_travel"] <= row["true_travel"] + ROUNDED for row in motions)
    assert summary["touching"] == sum(row["true_solid"] is not None for row in motions) > 0
    assert 0 <= summary["median_shortfall_voxels"] <= 1.5
    assert "median shortfall" in capsys.readouterr().out


def test_the_same_seed_gives_the_same_rows(tmp_path):
    pytest.importorskip("coal", reason="coal is not installed; exact mesh distance is left out")
    runs = []
    for name in ("a.json", "b.json"):
        argv = ["evaluate", "poses", "--poses", "1", *SMALL, "--json", str(tmp_path / name)]
        assert run(argv) == 0
        runs.append(rows_of(tmp_path / name))
    assert runs[0] == runs[1]


@pytest.mark.filterwarnings("default::elbowroom.errors.UnfinishedWarning")
def test_ctrl_c_shows_what_there_is_and_keeps_it_aside(tmp_path, monkeypatch, capsys):
    from elbowroom.evaluate.rooms import alone

    rows = alone.alone_rows

    def interrupted(*args, **options):
        yield next(rows(*args, **options))
        raise KeyboardInterrupt

    monkeypatch.setattr(alone, "alone_rows", interrupted)
    out = tmp_path / "out.json"
    assert run(["evaluate", "alone", "--poses", "3", *SMALL, "--json", str(out)]) == 130
    told = capsys.readouterr()
    assert "all clear" in told.out and "Interrupted after 1 of 24" in told.out
    (part,) = tmp_path.iterdir()
    assert part.name == "out.part.json" and "until then are in" in told.err
    assert len(json.loads(part.read_text())["rows"]) == 1


@pytest.mark.filterwarnings("default::elbowroom.errors.UnfinishedWarning")
def test_an_error_loses_no_row_that_was_measured(tmp_path, monkeypatch, capsys):
    from elbowroom.evaluate.rooms import alone

    rows = alone.alone_rows

    def ended(*args, **options):
        yield next(rows(*args, **options))
        raise InputError("the room is gone")

    monkeypatch.setattr(alone, "alone_rows", ended)
    out = tmp_path / "out.json"
    assert run(["evaluate", "alone", "--poses", "3", *SMALL, "--json", str(out)]) == 2
    told = capsys.readouterr()
    assert "Ended by an error after 1 of 24" in told.out and "the room is gone" in told.err
    assert [path.name for path in tmp_path.iterdir()] == ["out.part.json"]


@pytest.mark.parametrize("command", ["poses", "travel"])
def test_without_coal_one_line_names_the_extra(monkeypatch, capsys, command):
    monkeypatch.setitem(sys.modules, "coal", None)
    assert run(["evaluate", command, "--poses", "1"]) == 2
    captured = capsys.readouterr()
    assert "-m pip install" in captured.err and "coal" in captured.err and captured.out == ""
