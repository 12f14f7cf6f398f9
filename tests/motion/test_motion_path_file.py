import json

import numpy as np
import pytest

from elbowroom.errors import JointsError
from elbowroom.motion import read_path


def written(folder, name, text):
    path = folder / name
    path.write_text(text)
    return path


def test_a_table_and_a_message_say_the_same_path(tmp_path):
    table = "time_ms,slide,turn,slide_velocity,turn_velocity\n0,0,0.5,0,0\n1500,0.1,-0.5,0.2,0.1\n"
    points = [
        {"positions": [0, 0.5], "velocities": [0, 0], "time_from_start": {"sec": 0, "nanosec": 0}},
        {
            "positions": [0.1, -0.5],
            "velocities": [0.2, 0.1],
            "time_from_start": {"sec": 1, "nanosec": 500000000},
        },
    ]
    message = {"joint_names": ["slide", "turn"], "points": points}
    read = [
        read_path(written(tmp_path, "path.csv", table)),
        read_path(written(tmp_path, "path.json", json.dumps(message))),
        read_path(written(tmp_path, "goal.yaml", json.dumps({"trajectory": message}))),
    ]
    for path in read:
        assert path.joint_names == ("slide", "turn")
        assert path.times_s.tolist() == [0.0, 1.5]
        assert path.positions.tolist() == [[0, 0.5], [0.1, -0.5]]
        assert np.array_equal(path.velocities, [[0, 0], [0.2, 0.1]])


def test_velocities_may_be_left_out_and_times_be_plain(tmp_path):
    assert read_path(written(tmp_path, "a.csv", "slide,time_s\n0,0\n0.1,1e0\n")).velocities is None
    plain = "joint_names: [slide]\npoints:\n- {time_s: 0.0, positions: [0.0]}\n- {time_from_start: 2, positions: [1]}\n"
    assert read_path(written(tmp_path, "a.yaml", plain)).times_s.tolist() == [0.0, 2.0]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.csv", "", "header is ''"),
        ("a.csv", "slide,turn\n0,0\n", "one column of times"),
        ("a.csv", "time_s\n0\n", "no joint"),
        ("a.csv", "time_s,slide,slide\n0,0,0\n", "each name once"),
        ("a.csv", "time_s,time_ms,slide\n0,0,0\n", "one column of times"),
        ("a.csv", "time_s,slide\n", "no rows"),
        ("a.csv", "time_s,slide\n0\n", "line 2: 1 values"),
        ("a.csv", "time_s,slide\n0,zero\n", "line 2: slide is 'zero'"),
        ("a.csv", "time_s,slide\n0,nan\n", "positions of point 0"),
        ("a.csv", "time_s,slide\n1,0\n0,0\n", "strictly rise"),
        ("a.csv", "time_s,a,b,a_velocity\n0,0,0,0\n", "joint b has no column b_velocity"),
        ("a.txt", "time_s,slide\n0,0\n", "not .txt"),
        ("a.yaml", "points: []", "joint_names"),
        ("a.yaml", "joint_names: [a]\npoints: []", "points"),
        ("a.yaml", "joint_names: [a]\npoints: [{time_s: 0}]", "positions: missing"),
        ("a.yaml", "joint_names: [a]\npoints: [{time_s: 0, positions: [1, 2]}]", "must be 1 numbers"),
        ("a.yaml", "joint_names: [a]\npoints: [{time_s: 0, positions: [true]}]", "must be 1 numbers"),
        ("a.yaml", "joint_names: [a]\npoints: [{positions: [0]}]", "no time"),
        (
            "a.yaml",
            "joint_names: [a]\npoints: [{time_s: 0, positions: [0], velocities: [1]}, {time_s: 1, positions: [0]}]",
            "point 1: no velocities",
        ),
        ("a.json", "[1, 2", "a.json"),
    ],
)
def test_what_is_no_path_is_said_with_the_file(tmp_path, name, text, said):
    with pytest.raises(JointsError, match=said) as raised:
        read_path(written(tmp_path, name, text))
    assert name in str(raised.value)


def test_a_file_that_is_not_there_is_said(tmp_path):
    with pytest.raises(JointsError, match="no such file"):
        read_path(tmp_path / "none.csv")
