"""Heartbeats as bytes, and what the watchdog makes of them: all but a young, known one is stop."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from elbowroom.errors import InputError
from elbowroom.guard.heartbeat import LENGTH, PHASES, Heartbeat, Word
from elbowroom.guard.reason import Reason
from elbowroom.guard.registers import MOST_MOTIONS, crc16, register_count, registers
from elbowroom.guard.watch import Watched

MS = 1_000_000
GO = Word(800, 1, Reason.SURFACE)
BEAT = Heartbeat(7, 1000 * MS, 100 * MS, PHASES.index("guarding"), GO, (GO, Word(1000, 3, 1)))
WORDS = st.builds(
    lambda speed, level, reason, held, escapes: Word(speed, level if speed else 0, reason, held, escapes),
    st.integers(0, 1000),
    st.integers(1, 3),
    st.sampled_from(Reason).map(int),
    st.booleans(),
    st.booleans(),
)
BEATS = st.builds(
    Heartbeat,
    st.integers(0, 2**64 - 1),
    st.integers(-(2**63), 2**63 - 1),
    st.integers(1, 2**40),
    st.integers(0, len(PHASES) - 1),
    WORDS,
    st.lists(WORDS, max_size=8).map(tuple),
    st.integers(0, 2**62),
    st.integers(0, 2**32 - 1),
)


@given(BEATS)
def test_heartbeat_comes_back_as_it_was(beat: Heartbeat) -> None:
    packed = beat.packed()
    assert LENGTH.unpack_from(packed)[0] == len(packed) - LENGTH.size
    assert Heartbeat.unpacked(packed[LENGTH.size :]) == beat


def test_heartbeat_cut_or_changed_is_none() -> None:
    packed = BEAT.packed()[LENGTH.size :]
    for length in range(len(packed)):
        with pytest.raises(InputError):
            Heartbeat.unpacked(packed[:length])
        with pytest.raises(InputError):
            Heartbeat.unpacked(packed[:length] + bytes([packed[length] ^ 1]) + packed[length + 1 :])


@given(st.binary(max_size=200))
def test_any_bytes_are_no_heartbeat(data: bytes) -> None:
    with pytest.raises(InputError):
        Heartbeat.unpacked(data)


def test_stop_is_a_speed_of_zero_and_nothing_else() -> None:
    for per_mille, level in ((0, 1), (1, 0), (1001, 3), (-1, 0), (5, 4)):
        with pytest.raises(InputError):
            Word(per_mille, level, 1)


def after(*ages_ms: float, watched: Watched | None = None) -> Watched:
    """A watchdog that heard `BEAT` and looked at the clock when it was so old."""
    watched = (watched or Watched(2)).hearing(BEAT)
    for age_ms in ages_ms:
        watched = watched.looking(BEAT.finished_ns + round(age_ms * MS))
    return watched


@pytest.mark.parametrize(
    ("age_ms", "speed"), [(0, 800), (100, 800), (200, 800), (201, 0), (10_000, 0), (-101, 0)]
)
def test_two_deadlines_of_silence_are_stop(age_ms: float, speed: int) -> None:
    said = after(age_ms).said(BEAT.finished_ns + round(age_ms * MS))
    assert said.machine.per_mille == speed
    assert PHASES[said.phase] == ("guarding" if speed else "silent")
    assert said.age_ms == max(0, min(age_ms, 65535))


def test_nothing_heard_is_stop() -> None:
    said = Watched(3).looking(5).said(5)
    assert {word.per_mille for word in (said.machine, *said.motions)} == {0}
    assert said.age_ms == 65535 and PHASES[said.phase] == "starting" and len(said.motions) == 3


def test_after_silence_it_is_stop_until_the_gate_knows() -> None:
    now_ns = BEAT.finished_ns + 250 * MS
    watched = after(50, 250)
    assert watched.trips == 1 and watched.looking(now_ns + 9 * MS).trips == 1
    late = replace(BEAT, sequence=8, finished_ns=now_ns)
    watched = watched.hearing(late).looking(now_ns)
    assert watched.said(now_ns).machine.per_mille == 0
    watched = watched.hearing(replace(late, sequence=9, trips_known=1))
    assert watched.said(now_ns).machine.per_mille == 800


def test_old_and_doubled_heartbeats_are_no_news() -> None:
    watched = after()
    for sequence in (7, 6, 0):
        assert watched.hearing(replace(BEAT, sequence=sequence, finished_ns=2000 * MS)) is watched
    assert watched.hearing(replace(BEAT, sequence=8, motions=(GO,))) is watched


def test_dead_monitor_and_broken_output_are_stop() -> None:
    now_ns = BEAT.finished_ns + MS
    dead = replace(after(1), ended="gone").looking(now_ns)
    assert dead.said(now_ns).machine == Word.stop(Reason.SILENCE) and dead.trips == 1
    broken = replace(after(1), broken="callback")
    assert broken.said(now_ns).machine == Word.stop(Reason.OUTPUT)


def test_what_is_held_is_let_go_without_the_monitor() -> None:
    held = replace(BEAT, motions=(replace(GO, held=True), GO), held_until_ns=BEAT.finished_ns + 50 * MS)
    watched = Watched(2).hearing(held)
    assert watched.said(BEAT.finished_ns + 50 * MS).motions[0].per_mille == 800
    let_go = watched.said(BEAT.finished_ns + 51 * MS)
    assert let_go.motions[0].per_mille == 0 and let_go.motions[0].level == 0
    assert let_go.motions[1].per_mille == 800


@given(BEATS, st.integers(0, 2**62))
def test_registers_are_16_bits_and_checked(beat: Heartbeat, now_ns: int) -> None:
    words = registers(Watched(len(beat.motions)).hearing(beat).looking(now_ns).said(now_ns))
    assert len(words) == register_count(len(beat.motions))
    assert all(0 <= word <= 0xFFFF for word in words)
    assert words[-1] == crc16(words[:-1])


def test_checksum_is_the_one_that_modbus_has() -> None:
    assert (
        crc16([int.from_bytes(b"12"), int.from_bytes(b"34"), int.from_bytes(b"56"), int.from_bytes(b"78")])
        == 0x37DD
    )


def test_no_more_motions_than_one_request_reads() -> None:
    assert register_count(MOST_MOTIONS) <= 125
    with pytest.raises(InputError, match="at most 57"):
        register_count(MOST_MOTIONS + 1)


def test_every_reason_says_something_and_keeps_its_number() -> None:
    assert all(reason.sentence for reason in Reason)
    assert {reason.name: reason.value for reason in Reason} == {
        "UNSAID": 0, "NONE": 1, "SURFACE": 2, "MACHINE": 3, "BLIND": 4, "OUTSIDE_GRID": 5, "UNSEEN": 6, "KEPT_OUT": 7,
        "OFF_PATH": 8,
        "STARTING": 16, "RISING": 17, "RESET_DUE": 18, "ENDED": 19, "JOINTS_STARTING": 20, "CAMERA_DOUBTED": 21,
        "FAULT": 32, "STALE": 33, "INPUT": 34, "WATCH": 35, "SILENCE": 36, "WATCHDOG": 37, "OUTPUT": 38,
        "LATCH_FILE": 39, "UNCLEAN_END": 40, "CLOCK": 41,
        "CAMERA_DISCONNECTED": 48, "CAMERA_GAPS": 49, "CAMERA_DAMAGED": 50, "CAMERA_WRONG_SIZE": 51, "CAMERA_CLOCK": 52,
        "CAMERA_FROZEN": 53, "CAMERA_SWAPPED": 54, "CAMERA_WRONG_SCALE": 55, "CAMERA_WRONG_ENCODING": 56,
        "CAMERA_COVERED": 57, "CAMERA_PARTLY_COVERED": 58, "CAMERA_TOO_OLD": 59, "CAMERA_MOVED": 60,
        "JOINTS_MISSING": 64, "JOINTS_BEYOND": 65, "JOINTS_IMPLAUSIBLE": 66, "JOINTS_FROZEN": 67,
    }  # fmt: skip
