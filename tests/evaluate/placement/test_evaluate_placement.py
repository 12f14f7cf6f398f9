"""`elbowroom evaluate placement`: parts of the figures, and a prediction beside what is found."""

import json
from dataclasses import dataclass

import pytest

from elbowroom.cli import run
from elbowroom.evaluate.placement.effort import FULL, QUICK
from elbowroom.evaluate.placement.prediction import compared
from elbowroom.evaluate.placement.rows import DUE, PARTS, ROWS


@dataclass
class Rehearsed:
    """What `compared` asks of a rehearsal."""

    free_pct: float
    free_error_pct: float = 0.01
    scenes: tuple = (0, 1)


def test_one_prediction_is_held_against_the_mean_and_several_room_by_room():
    one = compared([Rehearsed(96.0)], [95.0, 96.0])
    assert (one["difference_pct"], one["scenes"], one["moments"]) == (pytest.approx(0.5), 2, 2)
    several = compared([Rehearsed(96.0), Rehearsed(90.0)], [96.1, 92.0])
    assert several["difference_pct"] == pytest.approx(-2.0)


def test_fewer_cameras_are_due_where_more_is_reached_anyway():
    (cameras, share, _) = DUE["optimise"]
    assert cameras.met({"cameras": 21, "wanted_share_pct": 98.9})
    assert not cameras.met({"cameras": 21, "wanted_share_pct": 98.26})
    assert cameras.met({"cameras": 15, "wanted_share_pct": 98.26})
    assert share.met({"valid_pct": 98.26, "wanted_share_pct": 98.2601})


def test_the_command_measures_the_parts_that_are_named(tmp_path, capsys):
    out = tmp_path / "out.json"
    argv = ["evaluate", "placement", "--quick", "--part", "verify", "--json", str(out)]
    assert run(argv) == 0
    (row,) = json.loads(out.read_text())["rows"]
    assert (row["kind"], row["cameras"], row["points"]) == ("verify", 21, 320_000)
    assert 97 < row["valid_pct"] < 100 and row["max_s"] >= row["median_s"] > 0
    assert "1 at most" in capsys.readouterr().out


def test_an_unknown_part_is_refused_with_all_that_are_known(capsys):
    assert run(["evaluate", "placement", "--part", "verify", "--part", "wobble"]) == 2
    assert f"parts are {', '.join(PARTS)}" in capsys.readouterr().err
    assert ROWS.keys() == PARTS.keys()
    assert QUICK.seconds < FULL.seconds and 21 in QUICK.counts
