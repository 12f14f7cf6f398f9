"""Result files say what was run on what, and are whole or not there."""

import json
from enum import Enum
from pathlib import Path

import numpy as np
import pytest

from elbowroom.errors import InputError, UnfinishedWarning
from elbowroom.files.json_rows import json_rows, meta, write_json


class Colour(Enum):
    RED = "red"


def test_rows_come_back_as_plain_values(tmp_path):
    row = {
        "a": np.float64(1.5),
        "b": np.arange(2),
        "c": (1, None),
        "d": {"e": Path("x")},
        "f": np.bool_(True),
    }
    write_json(tmp_path / "out.json", [row, {"name": "grün"}])
    content = json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))
    assert content["rows"] == [
        {"a": 1.5, "b": [0, 1], "c": [1, None], "d": {"e": "x"}, "f": True},
        {"name": "grün"},
    ]
    assert set(content["meta"]) == {"command", "commit", "processor", "versions"}


@pytest.mark.parametrize("number", [float("nan"), float("inf"), np.float64("-inf"), np.array([np.nan])])
def test_numbers_that_json_does_not_know_are_null(tmp_path, number):
    write_json(tmp_path / "out.json", [{"x": number}])
    (row,) = json.loads((tmp_path / "out.json").read_text())["rows"]
    assert row["x"] in (None, [None])


def test_no_rows_are_a_whole_file_too(tmp_path):
    write_json(tmp_path / "out.json", [])
    assert json.loads((tmp_path / "out.json").read_text())["rows"] == []


@pytest.mark.filterwarnings("ignore::elbowroom.errors.UnfinishedWarning")
@pytest.mark.parametrize("interruption", [ValueError, KeyboardInterrupt])
def test_an_interrupted_command_leaves_no_file_that_looks_whole(tmp_path, interruption):
    with pytest.raises(interruption), json_rows(tmp_path / "out.json") as add:
        add({"x": 1})
        raise interruption
    assert not (tmp_path / "out.json").exists()


@pytest.mark.parametrize(
    ("end", "how"),
    [
        (KeyboardInterrupt, "interrupted"),
        (InputError, "ended by an error"),
        (MemoryError, "ended by an error"),
    ],
)
def test_what_was_found_until_ctrl_c_or_an_error_is_kept_aside_and_said(end, how, tmp_path):
    path = tmp_path / "run.json"
    said = pytest.warns(UnfinishedWarning, match=rf"{how}; the 2 rows until then are in .*run\.part\.json")
    with said, pytest.raises(end), json_rows(path) as add:
        add({"a": "äöü"})
        add({"b": 2})
        raise end
    part = tmp_path / "run.part.json"
    assert [path.name for path in tmp_path.iterdir()] == ["run.part.json"]
    kept = json.loads(part.read_text(encoding="utf-8"))
    assert kept["rows"] == [{"a": "äöü"}, {"b": 2}] and kept["meta"]["unfinished"] is True


def test_where_what_there_was_cannot_be_kept_the_error_itself_is_said(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("elbowroom.files.json_rows._keep_part", full)
    with pytest.raises(ValueError, match="what ended it"), json_rows(tmp_path / "run.json") as add:
        add({"a": 1})
        raise ValueError("what ended it")
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_is_said_before_the_work(tmp_path):
    with (
        pytest.raises(InputError, match="name a folder that exists"),
        json_rows(tmp_path / "no" / "out.json"),
    ):
        pytest.fail("the block must not begin")


def test_without_a_file_rows_are_dropped():
    with json_rows(None) as add:
        add({"x": object()})


def test_meta_names_versions_processor_and_source():
    found = meta()
    assert {"elbowroom", "python", "numpy", "numba"} <= set(found["versions"])
    assert "cores" in found["processor"]
    assert found["commit"] and found["command"].startswith("elbowroom")
