"""A figure that is due is said once and read by commands and pages."""

import pytest

from elbowroom.evaluate.due import Due, due_of, figure_of, sentence, where
from elbowroom.evaluate.tables import table_of
from elbowroom.evaluate.thesis.due import DueLine, due_table, first
from elbowroom.evaluate.thesis.part import Part, about
from elbowroom.evaluate.thesis.parts import PARTS

FOUND = Due("found_pct", "≥", 97.0, where(edge=2), "found at 2 cm")


@pytest.mark.parametrize(("value", "met"), [(97.0, True), (96.9, False), (None, False)])
def test_at_least_is_met_by_the_figure_and_by_no_less_nor_by_nothing(value, met):
    assert FOUND.met({"edge": 2, "found_pct": value}) is met


def test_at_most_is_met_by_the_figure_and_by_no_more():
    none = Due("unsafe", "≤", 0)
    assert none.met({"unsafe": 0}) and not none.met({"unsafe": 1})


def test_a_row_may_have_a_figure_of_its_own():
    due = Due("named", "≥", lambda row: row["runs"])
    assert due.met({"named": 21, "runs": 21}) and not due.met({"named": 20, "runs": 21})
    with pytest.raises(TypeError, match="named"):
        _ = due.said


def test_a_figure_is_due_of_the_rows_that_it_speaks_of():
    assert due_of([FOUND], "found_pct", {"edge": 2}) is FOUND
    assert due_of([FOUND], "found_pct", {"edge": 5}) is None
    assert due_of([FOUND], "occupied_pct") is None
    assert figure_of([FOUND], "found_pct") == 97.0


def test_words_have_the_unit_of_the_key():
    said = [Due("stop_pct", "≤", 10.0).said, Due("median_ms", "≤", 25).said, Due("milder", "≤", 0).said]
    assert said == ["10 % at most", "25 ms at most", "0"]
    assert sentence([FOUND], "with 21 cameras") == "Due with 21 cameras: found at 2 cm 97 % at least."


def part_of(*due):
    return Part("part", "Title", lambda settings: [], lambda rows: [], lambda rows, pictures: [], due)


def test_the_table_shows_the_worst_row_and_says_what_misses():
    line = DueLine("kept_pct", "≥", 99.99, where(kind="a"), name="kept, of {of}", thesis="91", digits=4)
    rows = [{"part": "part", "kind": "a", "kept_pct": value, "of": 6} for value in (100.0, 99.98999)]
    table = due_table([part_of(FOUND, line)], rows)
    assert table is not None
    assert table.lines == [("kept, of 6", "91", "99.99", "99.9899", "missed")]
    assert due_table([part_of(line)], [{**row, "part": "other"} for row in rows]) is None


def test_of_variants_the_first_is_the_one_that_is_due():
    line = DueLine("u", "≤", 0, name="unsafe", pick=first, beside=lambda row: row["name"])
    rows = [{"part": "part", "u": 0, "name": "ours"}, {"part": "part", "u": 4, "name": "theirs"}]
    table = due_table([part_of(line)], rows)
    assert table is not None and table.lines == [("unsafe", "", "0", "0", "reached; ours")]


def test_parts_of_the_experiments_are_called_as_their_modules():
    assert list(PARTS) == ["reconstruction", "motions", "calibration", "scale", "more"]
    assert all(PARTS[name].due for name in ("reconstruction", "motions", "calibration", "scale"))
    assert about("First line.\n\nWhat is\nasked.").text == "What is asked."


def test_cells_are_formats_or_functions_of_a_row():
    table = table_of("title", [{"a": 1, "b": 2.0}], {"x": "{a}", "y": lambda row: f"{row['b']:.1f}"}, ["y"])
    assert (table.columns, table.lines, list(table.left)) == (("x", "y"), [["1", "2.0"]], [1])
