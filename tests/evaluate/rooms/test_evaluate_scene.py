"""How a verdict is compared with the truth."""

import pytest

from elbowroom.evaluate.rooms.exact import Contact
from elbowroom.evaluate.rooms.poses import poses_summary
from elbowroom.evaluate.rooms.scene import Comparison, lean
from elbowroom.motion import Cause, Level, Motion, Verdict

MOTION = Motion("turn", 1, 0.1)


def comparison(free_travel, contact, *, blocked=True):
    level = Level.at(free_travel, 0.1) if blocked else Level.CLEAR
    cause = Cause.SURFACE if blocked else Cause.NONE
    return Comparison(MOTION, Verdict(MOTION, level, free_travel, "rad", None, None, cause), contact)


@pytest.mark.parametrize(
    ("free_travel", "truth", "milder"),
    [
        (0.05, 0.15, False),
        (0.15, 0.15, False),
        (0.1500001, 0.15, True),
        (0.25, 0.15, True),
        (0.0, 0.0, False),
    ],
)
def test_more_travel_than_the_truth_is_milder(free_travel, truth, milder):
    assert comparison(free_travel, Contact(truth, 0.5, "arm", "wall", 1.0)).milder is milder


def test_clear_where_something_is_touched_is_milder():
    assert comparison(0.5, Contact(0.45, 0.5, "arm", "wall", 1.0), blocked=False).milder
    assert not comparison(0.5, Contact(0.5, 0.5), blocked=False).milder


def test_a_way_that_a_limit_cuts_short_is_not_truly_clear():
    assert comparison(0.1, Contact(0.5, 0.5)).truly_clear
    cut = comparison(0.05, Contact(0.2, 0.2))
    assert not cut.truly_clear and cut.true_level is Level.CLEAR


def test_a_row_of_a_file_leaves_out_what_the_summary_says():
    row = {"pose": 3, "seed": 2, "cameras": 21, "width": 640, "free_travel": 0.123456789, "link": None}
    assert lean(row) == {"pose": 3, "free_travel": 0.123457, "link": None}


def test_the_summary_counts_each_kind():
    rows = [
        {"pose": 0, **comparison(0.05, Contact(0.5, 0.5)).row()},
        {"pose": 0, **comparison(0.5, Contact(0.5, 0.5), blocked=False).row()},
        {"pose": 1, **comparison(0.3, Contact(0.05, 0.5, "arm", "wall", 1.0)).row()},
    ]
    summary = poses_summary(rows)
    assert (summary["poses"], summary["verdicts"]) == (2, 3)
    assert (summary["milder"], summary["milder_level"]) == (1, 1)
    assert (summary["truly_clear"], summary["stop_where_clear"]) == (2, 1)
    assert summary["stop_where_clear_pct"] == summary["clear_where_clear_pct"] == 50
