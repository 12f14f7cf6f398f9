"""`elbowroom evaluate looks`: few sites."""

import json

import numpy as np

from elbowroom.cli import run
from elbowroom.evaluate.looks.looks import looks_summary, right_rows, wrong_rows
from elbowroom.evaluate.looks.random_site import random_site
from elbowroom.evaluate.looks.wrong import WRONG


def test_a_random_site_is_the_same_by_its_number():
    one, again = random_site(7), random_site(7)
    assert [camera.name for camera in one.cameras] == [camera.name for camera in again.cameras]
    for name, raw in one.codes.items():
        np.testing.assert_array_equal(raw, again.codes[name])


def test_random_sites_are_passed_and_wrong_ones_are_said():
    rows = [*wrong_rows(2)]
    assert len(rows) == 2 * len(WRONG)
    assert all(row["said_at_all"] and row["stops"] for row in rows)


def test_the_command_writes_a_row_for_each_room_and_one_for_each_kind(tmp_path):
    out = tmp_path / "looks.json"
    args = ["evaluate", "looks", "--sites", "4", "--wrong", "1", "--no-rooms", "--json", str(out)]
    assert run(args) == 0
    rows = json.loads(out.read_text())["rows"]
    summary = [row for row in rows if "scenes" in row]
    assert {row["kind"] for row in summary} == {"as it should be", *WRONG}
    assert summary[0]["refused"] == 0


def test_nothing_in_nothing_out():
    assert looks_summary([]) == []
    assert list(wrong_rows(0)) == []
    assert list(right_rows(0)) == []
