"""The whole monitor for long: here for seconds, with small images, recorded by two sinks and guarded by its gate."""

import json

import pytest

from elbowroom.evaluate.soak.soak import DUE, MOMENTS, RATE_HZ, soak_rows, words_of_worst


@pytest.fixture(scope="module")
def row():
    told = []
    (found,) = soak_rows(4.0, cameras=4, size=(64, 48), tell=told.append)
    assert told
    return found


def test_every_pass_is_judged_and_recorded(row) -> None:
    assert (row["cameras"], row["width"], row["height"]) == (4, 64, 48)
    assert row["passes"] >= MOMENTS and row["rate_hz"] <= RATE_HZ + 1
    assert row["lost"] == 0 and not row["troubles"] and row["file_mb_s"] > 0
    assert 0 < row["median_ms"] <= row["p99_ms"] <= row["max_ms"]
    json.dumps(row)


def test_the_worst_pass_is_said_with_where_its_time_went(row) -> None:
    words = words_of_worst(row)
    assert words.startswith("at ") and " s: " in words
    parts = {name: ms for name, ms in row["worst"].items() if name not in ("at_s", "age_ms")}
    assert max(parts, key=lambda name: parts[name]).removesuffix("_ms") in words


def test_what_is_due_is_of_the_row(row) -> None:
    assert {each.key for each in DUE} <= set(row)
