import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import JointsError
from elbowroom.sensing import JointRecord
from elbowroom.sensing.joints import END_SLACK_NS

NOW = 1_700_000_000_000_000_000


@pytest.fixture
def record():
    return JointRecord(
        np.array([NOW, NOW + 100, NOW + 300]),
        {"long": np.array([0.0, 1.0, 5.0]), "larm": np.array([2.0, 2.0, 0.0])},
    )


def test_rows_are_met_exactly(record):
    for row, stamp in enumerate(record.stamps_ns):
        assert record.at(int(stamp)) == {
            "long": record.positions["long"][row],
            "larm": record.positions["larm"][row],
        }


def test_between_rows_it_is_straight_even_at_stamps_that_floats_cannot_hold(record):
    assert record.at(NOW + 50) == {"long": 0.5, "larm": 2.0}
    assert record.at(NOW + 250) == {"long": 4.0, "larm": 0.5}


@given(offset=st.integers(0, 300))
def test_between_rows_it_stays_between_their_positions(offset):
    record = JointRecord(np.array([NOW, NOW + 100, NOW + 300]), {"long": np.array([0.0, 1.0, 5.0])})
    low, high = (0.0, 1.0) if offset <= 100 else (1.0, 5.0)
    assert low <= record.at(NOW + offset)["long"] <= high


def test_outside_the_record_nothing_is_invented(record):
    assert record.at(NOW - END_SLACK_NS)["long"] == 0.0
    assert record.at(NOW + 300 + END_SLACK_NS)["long"] == 5.0
    for stamp in (NOW - END_SLACK_NS - 1, NOW + 301 + END_SLACK_NS):
        with pytest.raises(JointsError, match=f"joints at {stamp} ns: not known, the record spans {NOW} to"):
            record.at(stamp)


def test_a_gap_too_wide_is_not_bridged(record):
    record = JointRecord(record.stamps_ns, record.positions, max_gap_ns=150)
    assert record.at(NOW + 50)["long"] == 0.5
    assert record.at(NOW + 300)["long"] == 5.0
    with pytest.raises(JointsError, match=r"gap of 0\.0002 ms"):
        record.at(NOW + 200)


def test_positions_cannot_be_changed(record):
    with pytest.raises(ValueError, match="read-only"):
        record.positions["long"][0] = 3.0


@pytest.mark.parametrize(
    ("stamps", "positions", "message"),
    [
        ([], {"a": []}, "at least one"),
        ([1.5, 2.5], {"a": [0, 0]}, "whole nanoseconds"),
        ([1, 1], {"a": [0, 0]}, r"stamps_ns\[1\] is 1 after 1"),
        ([1, 2], {}, "no joints"),
        ([1, 2], {"a": [0.0]}, r"a has shape \(1,\)"),
        ([1, 2], {"a": [0.0, float("nan")]}, r"a\[1\] is nan"),
    ],
)
def test_unusable_records_are_refused(stamps, positions, message):
    with pytest.raises(JointsError, match=message):
        JointRecord(np.array(stamps), {name: np.array(values) for name, values in positions.items()})


def test_csv_is_read_with_whole_stamps(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text(f"stamp_ns, long, larm\n{NOW},0.25,-1e-3\n\n{NOW + 1},0.5,0\n")
    record = JointRecord.from_csv(path)
    assert record.joints == ("long", "larm")
    assert record.stamps_ns.tolist() == [NOW, NOW + 1]
    assert record.at(NOW) == {"long": 0.25, "larm": -0.001}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: header is '', must be stamp_ns,<joint>"),
        ("time,long\n1,2\n", "line 1: header is 'time,long'"),
        ("stamp_ns,long,long\n1,2,3\n", "line 1: header has an empty or a doubled name"),
        ("stamp_ns,long\n", "no rows"),
        ("stamp_ns,long\n1,2\n2\n", "line 3: 1 values, the header names 2"),
        ("stamp_ns,long\n1.5,2\n", "line 2: stamp_ns is '1.5', must be whole"),
        ("stamp_ns,long\n99999999999999999999,2\n", "line 2: stamp_ns is 9+, must fit 64 bits"),
        ("stamp_ns,long\n5,2\n5,2\n", "line 3: stamp_ns is 5 after 5"),
        ("stamp_ns,long\n5,nan\n", "line 2: long is 'nan', must be a finite number"),
        ("stamp_ns,long\n5,up\n", "line 2: long is 'up', must be a finite number"),
    ],
)
def test_unusable_csv_is_one_line_with_its_number(tmp_path, text, message):
    path = tmp_path / "joints.csv"
    path.write_text(text)
    with pytest.raises(JointsError, match=message) as caught:
        JointRecord.from_csv(path)
    assert str(caught.value).startswith(str(path)) and "\n" not in str(caught.value)


def test_missing_or_binary_csv_is_refused(tmp_path):
    with pytest.raises(JointsError, match="no such file"):
        JointRecord.from_csv(tmp_path / "joints.csv")
    (tmp_path / "joints.csv").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(JointsError, match="not a CSV file"):
        JointRecord.from_csv(tmp_path / "joints.csv")
