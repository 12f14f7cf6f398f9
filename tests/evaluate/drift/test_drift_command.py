"""`elbowroom bench calibration --part`: drift is one of its parts."""

import pytest

from elbowroom.cli.evaluate.bench_calibration_run import MORE, run_bench_calibration
from elbowroom.errors import InputError
from elbowroom.evaluate.drift.rows import drift_rows


def test_drift_is_a_part_and_unknown_parts_are_refused_with_all_that_are_known():
    assert "drift" in MORE
    with pytest.raises(InputError, match=r"'wobble' is unknown; parts are .*, drift"):
        run_bench_calibration(False, None, ("wobble",), None)


def test_rows_tell_first_what_is_done():
    said = []
    row = next(drift_rows(said.append, passes=1))
    assert said[0] == "commissioning, noise tof" and "turn 1 degree about x" in said[1]
    assert row["kind"] == "knock" and row["runs"] == 21
