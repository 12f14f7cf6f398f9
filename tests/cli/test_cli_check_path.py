"""`elbowroom check --path` in the simulated room."""

import json

import pytest

from elbowroom.cli.check_path_run import ask_path
from elbowroom.errors import InputError, JointsError
from elbowroom.site import Site
from elbowroom.sources import open_room

HOME = {"long": 0.0, "larm": 0.0, "propeller": 0.0, "carc": 0.0}
SLOW = "time_s,long,larm\n0,0,0\n1,0.05,0.1\n2,0.1,0.3\n4,0.3,0.4\n"


@pytest.fixture(scope="module")
def room():
    return open_room(Site.simulated_room(), voxel_size_m=0.1, joints=HOME, cameras=8, resolution=(64, 48))


def written(folder, text):
    path = folder / "plan.csv"
    path.write_text(text)
    return path


def test_it_says_how_long_a_path_may_be_followed_and_what_ends_it(room, tmp_path, capsys):
    rows = tmp_path / "rows.json"
    ask_path(room, (written(tmp_path, SLOW), None), 0, rows)
    said = capsys.readouterr().out
    (row,) = json.loads(rows.read_text())["rows"]
    assert said.startswith(f"Path: {row['level']}.") and "Not a certified safety function" in said
    assert row["joints_of_path"] == ["long", "larm"] and row["leaves_path"] is True
    assert row["is_free"] is False
    if row["follow_until_s"] is None:
        assert "Not even a stop" in said
    else:
        assert f"{row['follow_until_s']:.2f} s of 0.00 to 4.00 s" in said


def test_a_path_of_another_moment_is_one_line_with_the_file(room, tmp_path):
    elsewhere = written(tmp_path, SLOW.replace("0,0,0", "0,0.2,0").replace("1,0.05", "1,0.21"))
    with pytest.raises(JointsError, match=r"plan\.csv: path: it begins with joint long"):
        ask_path(room, (elsewhere, None), 0, None)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, "--joint and --direction, or --path"),
        ({"joint": "long"}, "--joint and --direction, or --path"),
        ({"joint": "long", "direction": "+", "horizon": 1.0}, "--horizon: only with --path"),
        ({"path": "plan.csv", "joint": "long"}, "--joint: not with --path"),
        ({"path": "plan.csv", "out": "pictures"}, "--out: not with --path"),
        ({"path": "plan.csv", "horizon": 0.0}, "--horizon: is 0"),
    ],
)
def test_a_motion_or_a_path_is_asked_and_not_both(given, said):
    from elbowroom.cli.check import _asked

    arguments = dict.fromkeys(("joint", "direction", "path", "horizon", "out")) | given
    with pytest.raises(InputError, match=said):
        _asked(**arguments)
