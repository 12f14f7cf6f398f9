import numpy as np
import pytest

from elbowroom.errors import InputError, JointsError
from elbowroom.sensing import DepthFrame, JointRecord, Snapshot

RECORD = JointRecord(np.array([0, 100]), {"lift": np.array([0.0, 1.0])})


def frame(camera, stamp_ns):
    return DepthFrame(camera, stamp_ns, np.ones((2, 2)))


def test_a_record_is_asked_at_each_frames_time_and_now_is_the_newest():
    taken = Snapshot.taken([frame("a", 20), frame("b", 60)], RECORD, now_ns=90)
    assert taken.joints_at("a") == {"lift": pytest.approx(0.2)}
    assert taken.joints_at("b") == taken.joints == {"lift": pytest.approx(0.6)}


def test_positions_that_hold_hold_for_every_frame():
    taken = Snapshot.taken([frame("a", None)], {"lift": 0.5})
    assert taken.joints_at("a") == taken.joints == {"lift": 0.5}


def test_without_a_frame_a_record_is_asked_now():
    assert Snapshot.taken([], RECORD, now_ns=30).joints == {"lift": pytest.approx(0.3)}
    with pytest.raises(InputError, match="needs frames with times, or now_ns"):
        Snapshot.taken([], RECORD)


def test_a_record_is_not_asked_of_a_frame_without_a_time_nor_far_outside_it():
    with pytest.raises(InputError, match="frame of a: has no time"):
        Snapshot.taken([frame("a", None)], RECORD)
    with pytest.raises(JointsError, match="not known"):
        Snapshot.taken([frame("a", 10**9)], RECORD)


@pytest.mark.parametrize("limit, kept", [(None, "abcd"), (40, "b"), (50, "bd"), (100, "abd")])
def test_what_is_old_ahead_of_the_clock_or_without_a_time_is_not_fresh(limit, kept):
    frames = [frame("a", 0), frame("b", 80), frame("c", None), frame("d", 150)]
    fresh = Snapshot.taken(frames, None, now_ns=100).fresh(limit)
    assert "".join(each.camera for each in fresh.frames) == kept


def test_an_age_limit_needs_the_time_and_is_not_below_zero():
    with pytest.raises(InputError, match="give now_ns"):
        Snapshot((frame("a", 0),)).fresh(5)
    with pytest.raises(InputError, match="must be at least 0"):
        Snapshot((frame("a", 0),), now_ns=0).fresh(-1)


def test_the_oldest_frame_says_the_age():
    assert Snapshot((frame("a", 0), frame("b", 10**6)), now_ns=3 * 10**6).oldest_age_ms == 3.0
    assert Snapshot((frame("a", None),), now_ns=5).oldest_age_ms is None


def test_a_record_is_not_asked_of_a_frame_past_its_age():
    frames = [frame("a", -(10**9)), frame("b", 60), frame("c", None)]
    taken = Snapshot.taken(frames, RECORD, now_ns=90, max_age_ns=50)
    assert taken.frames == tuple(frames)
    assert set(taken.joints_of) == {"b"} and taken.joints == {"lift": pytest.approx(0.6)}


def test_where_the_machine_was_at_the_newest_frame():
    positions = {"a": {"lift": 0.1}, "b": {"lift": 0.2}}
    now = {"lift": 0.3}
    assert Snapshot((frame("b", 7), frame("a", 9), frame("c", None)), now, positions).joints_at_newest == {
        "lift": 0.1
    }
    assert Snapshot((frame("c", 9), frame("a", 7)), now, positions).joints_at_newest == now
    assert Snapshot((), now, positions).joints_at_newest == now


def test_what_a_clock_may_be_off_is_part_of_every_age():
    frames = (frame("a", 10**6), frame("b", 3 * 10**6))
    plain, bounded = (
        Snapshot(frames, now_ns=5 * 10**6),
        Snapshot(frames, now_ns=5 * 10**6, clock_bounds_ns={"a": 10**6}),
    )
    assert (plain.oldest_age_ms, bounded.oldest_age_ms) == (4.0, 5.0)
    assert plain.skew_ms == bounded.skew_ms == 2.0
    for limit in range(0, 7 * 10**6, 5 * 10**5):
        assert set(bounded.fresh(limit).frames) <= set(plain.fresh(limit).frames)
    assert [f.camera for f in bounded.fresh(4 * 10**6).frames] == ["b"]
    assert bounded.fresh(5 * 10**6).clock_bounds_ns == {"a": 10**6}
    assert Snapshot(frames[:1]).skew_ms is None
