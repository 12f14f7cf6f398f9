"""Two who tell one joint, and a clock that went back, are no other unit; smooth motion is neither."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import JointsError
from elbowroom.site import Site
from elbowroom.sources import moments, time_findings
from elbowroom.sources.times.two_tellers import clock_fall, steps_of, to_and_fro
from reference import bag_files as bags
from reference.bag_room import JOINT_STEP_NS, bag_room

MS, T0, FULL_SPEED = bags.MS, bags.T0, 0.5


def smooth(rows, speed, phase=0.0):
    """Times 20 ms apart, and a joint that swings at no more than a speed."""
    times = T0 + 20 * MS * np.arange(rows, dtype=np.int64)
    return times, speed * np.sin(np.arange(rows) * 0.02 + phase)


@given(st.integers(3, 300), st.floats(0, FULL_SPEED), st.floats(0, 6), st.sampled_from([1.0, 180 / np.pi]))
def test_a_smooth_motion_goes_nowhere_to_and_fro_in_any_unit(rows, speed, phase, unit):
    times, positions = smooth(rows, speed, phase)
    assert not to_and_fro(times, np.diff(positions * unit), 10 * FULL_SPEED)


@given(st.integers(40, 300), st.integers(1, 8), st.floats(0.3, 2.0), st.sampled_from([1, -1]))
def test_another_teller_is_found_however_often_it_tells(rows, every, away, sign):
    times, positions = smooth(rows, 0.1)
    told = np.concatenate([times, times[::every] + 7 * MS])
    values = np.concatenate([positions, positions[::every] + sign * away])
    order = np.argsort(told)
    steps = to_and_fro(told[order], np.diff(values[order]), 10 * FULL_SPEED)
    assert len(steps) >= 0.05 * len(told) and np.median(steps) == pytest.approx(away, abs=0.1)


@given(st.integers(0, 1000), st.floats(0, 0.2))
def test_a_joint_without_end_that_rests_at_half_a_turn_goes_nowhere(seed, speed):
    """Drivers tell it between -pi and pi, so that noise makes whole turns of it; one with limits cannot turn so."""
    times, positions = smooth(200, speed)
    turned = np.pi + positions + np.random.default_rng(seed).normal(0, 1e-4, 200)
    told = (turned + np.pi) % (2 * np.pi) - np.pi
    steps = steps_of(SimpleNamespace(kind="continuous"), told)
    assert steps == pytest.approx(np.diff(turned), abs=1e-9)
    assert not to_and_fro(times, steps, 10 * FULL_SPEED)
    assert (steps_of(SimpleNamespace(kind="revolute"), told) == np.diff(told)).all()


@given(st.integers(20, 400), st.integers(15, 900), st.integers(0, 300))
def test_a_clock_that_goes_back_is_seen_and_a_message_that_comes_late_is_not(rows, back_ms, late_ms):
    came = T0 + 20 * MS * np.arange(rows, dtype=np.int64)
    stamps = came - 5 * MS
    assert clock_fall("/j", np.stack([came, stamps], axis=1)) is None
    late = came.copy()
    late[rows // 2] += late_ms * MS
    order = np.argsort(late, kind="stable")
    assert clock_fall("/j", np.stack([late, stamps], axis=1)[order]) is None
    set_back = stamps - back_ms * MS * (np.arange(rows) >= rows // 2)
    said = clock_fall("/j", np.stack([came, set_back], axis=1))
    assert (said is None) == (back_ms <= 30)
    assert said is None or "the clock of /j went back by" in said


def site_of(tmp_path, messages):
    room = bag_room()
    bag = bags.written(tmp_path / "bag", sorted(messages, key=lambda m: m[1]))
    speeds = {"larm": {"max_speed_deg_s": 1, "braking_time_s": 0.5}}
    return Site.load(room.site(tmp_path / "site.yaml", room.recording(bag), joints=speeds))


def test_two_publishers_of_a_joint_are_named_and_not_called_degrees(tmp_path):
    room = bag_room()
    other = [
        ("/joint_states", at + 8 * MS, bags.joint_state(dict.fromkeys(joints, 0.4), at + 7 * MS))
        for at, joints in room.joints.items()
    ]
    with pytest.raises(JointsError, match="two publishers of joint larm on /joint_states") as caught:
        list(moments(site_of(tmp_path, [*room.messages(), *other])))
    assert "degrees" not in str(caught.value)


@pytest.mark.parametrize("by_ms", [100, 107])
def test_a_clock_of_joints_that_went_back_is_named(by_ms, tmp_path):
    """Whether its stamps meet those from before or lie between them."""
    room, half = bag_room(), T0 + 10 * JOINT_STEP_NS
    messages = [m for m in room.messages() if m[0] != "/joint_states"]
    for number, at in enumerate(room.joints):
        stamp = at - by_ms * MS * (at >= half)
        joints = dict.fromkeys(room.joints[at], 0.2 + 0.01 * number)
        messages.append(("/joint_states", at + MS, bags.joint_state(joints, stamp)))
    with pytest.raises(
        JointsError, match=f"the clock of /joint_states went back by 0.1{'07' * (by_ms == 107)} s"
    ):
        list(moments(site_of(tmp_path, messages)))


def test_a_clock_that_went_back_while_nothing_moved_is_said(tmp_path):
    room, half = bag_room(), T0 + 10 * JOINT_STEP_NS
    messages = [m for m in room.messages() if m[0] != "/joint_states"]
    for at in room.joints:
        stamp = at - 107 * MS * (at >= half)
        messages.append(("/joint_states", at + MS, bags.joint_state(room.joints[T0], stamp)))
    told = [finding.text for finding in time_findings(site_of(tmp_path, messages))]
    assert any("went back by 0.107 s" in text for text in told)
