"""`elbowroom evaluate looks`: few sites."""

import json

import numpy as np

from elbowroom.cli import run
from elbowroom.evaluate.looks.looks import SCALED_KIND, looks_summary, right_rows, wrong_rows
from elbowroom.evaluate.looks.random_site import random_site
from elbowroom.evaluate.looks.scaled import SCALED
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
    summary = looks_summary(rows)
    assert [row["kind"] for row in summary] == [*WRONG]
    assert all(row["scenes"] == 2 and row["unsaid_pct"] == 0 for row in summary)


def test_focal_lengths_that_are_off_have_rows_of_their_own():
    kinds = {name: SCALED[name] for name in ("focal length times 1.05, all", "focal length times 0.8, one")}
    rows = [*wrong_rows(1, kinds, SCALED_KIND)]
    little, much = looks_summary(rows)
    assert (little["what"], little["is_much"], much["is_much"]) == (SCALED_KIND, False, True)
    assert much["named"] == 1


def test_the_command_writes_a_row_for_each_room(tmp_path):
    out = tmp_path / "looks.json"
    args = ["evaluate", "looks", "--sites", "2", "--wrong", "0", "--no-rooms", "--json", str(out)]
    assert run(args) == 0
    rows = json.loads(out.read_text())["rows"]
    (summary,) = [row for row in rows if "scenes" in row]
    assert (summary["kind"], summary["scenes"], summary["refused"]) == ("as it should be", 2, 0)


def test_nothing_in_nothing_out():
    assert looks_summary([]) == []
    assert list(wrong_rows(0)) == []
    assert list(right_rows(0)) == []
