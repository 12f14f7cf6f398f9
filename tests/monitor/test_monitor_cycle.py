"""A pass gives a verdict for each motion, and stop for each that it has none for."""

from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import FrameError, InputError
from elbowroom.geometry import VoxelGrid
from elbowroom.monitor import Cycle, Health, Known, cycle
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.reconstruct import Terms
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.sensing import DepthFrame, Snapshot

GRID = VoxelGrid(origin_m=(0, 0, 0), shape=(4, 4, 4), voxel_size_m=0.1)
SPACE = FreeSpace.from_occupied(GRID, np.zeros(GRID.shape, dtype=bool))
NOTHING = Snapshot((), {}, now_ns=0)
NO_FRAMES_AT_ALL = Snapshot((None,), {}, now_ns=0)
MOTIONS = (Motion("slide", +1, 0.1), Motion("slide", -1, 0.1))


class OneJoint:
    """As much of a machine as a pass asks for itself."""

    class _Slide:
        name, unit = "slide", "m"

    joints = (_Slide(),)


def clear(motion: Motion, free_travel: float = 0.5) -> Verdict:
    return Verdict(motion, Level.CLEAR, free_travel, "m", None, None, Cause.NONE)


@pytest.fixture
def a_cycle(monkeypatch) -> Cycle:
    """A pass whose two stages answer that all is free and clear, unless a test lets them do otherwise."""

    def free_space_of(*_, timer, **__):
        with timer("carve"):
            return SPACE

    monkeypatch.setattr(cycle, "free_space_of", free_space_of)
    monkeypatch.setattr(
        cycle, "check_motions", lambda space, machine, joints, motions: [*map(clear, motions)]
    )
    return Cycle(GRID, (), OneJoint(), MOTIONS, focused=False)


def taken(*stamps_ns: int | None, now_ns: int = 7_000_000) -> Snapshot:
    image = np.ones((2, 2), np.float32)
    frames = [DepthFrame(f"c{i}", stamp, image) for i, stamp in enumerate(stamps_ns)]
    return Snapshot.taken(frames, {"slide": 0.0}, now_ns)


def assert_all_stop(result, reason: str):
    assert [v.motion for v in result.verdicts] == list(MOTIONS)
    assert all(v.level is Level.STOP and v.free_travel == 0 and not v.overridable for v in result.verdicts)
    assert {v.cause for v in result.verdicts} == {Cause.FAULT}
    assert result.level is Level.STOP
    assert reason in result.fault


def test_a_whole_pass_has_verdicts_times_and_no_fault(a_cycle):
    result = a_cycle.run(taken(2_000_000, 5_000_000))
    assert result.level is Level.CLEAR and result.fault is None and result.space.free.all()
    assert list(result.stage_ms) == ["carve", "motion"]
    assert result.cycle_ms == pytest.approx(sum(result.stage_ms.values()))
    assert result.oldest_age_ms == 5.0


def test_passes_are_numbered(a_cycle):
    assert [a_cycle.run(NOTHING).sequence for _ in range(3)] == [0, 1, 2]


def test_frames_without_stamps_have_no_age(a_cycle):
    assert a_cycle.run(taken(None)).oldest_age_ms is None


@pytest.mark.parametrize(
    "error", [FrameError("two frames of cam00"), ValueError("NaN"), MemoryError("no room")]
)
@pytest.mark.parametrize("stage", ["free_space_of", "check_motions"])
def test_whatever_is_raised_is_a_stop_with_its_reason(a_cycle, monkeypatch, stage, error):
    def fails(*_, **__):
        raise error

    monkeypatch.setattr(cycle, stage, fails)
    result = a_cycle.run(NOTHING)
    assert_all_stop(result, str(error))
    assert result.space is None


@pytest.mark.parametrize("snapshot", [NO_FRAMES_AT_ALL, None, "nonsense"])
def test_what_is_no_snapshot_is_a_stop(a_cycle, snapshot):
    assert_all_stop(a_cycle.run(snapshot), "AttributeError")


@pytest.mark.parametrize(
    "unusable",
    [
        None,
        clear(MOTIONS[1], float("nan")),
        clear(MOTIONS[1], -0.1),
        clear(Motion("another", 1, 0.1)),
        Verdict(MOTIONS[1], None, 0.5, "m", None, None, Cause.NONE),
    ],
)
def test_a_missing_or_meaningless_verdict_is_a_stop_for_its_motion(a_cycle, monkeypatch, unusable):
    monkeypatch.setattr(cycle, "check_motions", lambda *_: [clear(MOTIONS[0]), unusable])
    result = a_cycle.run(NOTHING)
    assert [v.level for v in result.verdicts] == [Level.CLEAR, Level.STOP]
    assert result.verdicts[1].free_travel_unit == "m"
    assert result.verdicts[1].cause is Cause.FAULT
    assert "slide -" in result.fault and "slide +" not in result.fault


def test_verdicts_in_another_order_stay_with_their_motions(a_cycle, monkeypatch):
    backwards = [clear(MOTIONS[1], 0.2), clear(MOTIONS[0], 0.1)]
    monkeypatch.setattr(cycle, "check_motions", lambda *_: backwards)
    assert [v.free_travel for v in a_cycle.run(NOTHING).verdicts] == [0.1, 0.2]


def aged(a_cycle: Cycle, took_ms: float, limit_ms: float | None = 200.0) -> Cycle:
    """The cycle, whose passes take so long by its clock."""
    ticks = iter(range(0, 10**12, round(took_ms * 1e6)))
    limit = None if limit_ms is None else round(limit_ms * 1e6)
    a_cycle.terms, a_cycle.clock_ns = Terms(max_age_ns=limit), lambda: next(ticks)
    return a_cycle


def test_what_is_too_old_when_the_pass_ends_is_a_stop_that_says_so(a_cycle):
    now = 10**9
    in_time = aged(a_cycle, 149).run(taken(now, now - 50 * 10**6, now_ns=now))
    assert in_time.level is Level.CLEAR and in_time.late is None
    late = aged(a_cycle, 151).run(taken(now, now - 50 * 10**6, now_ns=now))
    assert [v.level for v in late.verdicts] == [Level.STOP] * 2
    assert {v.cause for v in late.verdicts} == {Cause.STALE} and not late.verdicts[0].overridable
    assert late.stopped_by == late.late and late.fault is None and late.space is not None
    assert (
        "201 ms old when the verdicts are out, at most 200 ms are allowed (max_frame_age_ms); the pass took 151 ms"
        in late.late
    )


def test_the_age_at_the_end_is_that_of_frames_that_were_used(a_cycle):
    """What was left out at the beginning, being too old, stops nothing more."""
    now = 10**9
    dead_too = taken(now, now - 10**9, None, now_ns=now)
    assert aged(a_cycle, 100).run(dead_too).level is Level.CLEAR
    assert aged(a_cycle, 100).run(taken(now - 10**9, now_ns=now)).late is None


def test_a_pass_that_took_longer_than_frames_were_aged_for_is_a_stop(a_cycle):
    now = 10**9
    for took_ms, level in ((99, Level.CLEAR), (101, Level.STOP)):
        each = aged(a_cycle, took_ms)
        each.terms = Terms(pass_ns=100_000_000)
        result = each.run(taken(now, now_ns=now))
        assert {verdict.level for verdict in result.verdicts} == {level}
    assert result.verdicts[0].cause is Cause.STALE
    assert "took 101 ms, and space was judged for 100 ms (pass_time_ms)" in result.late


def test_without_a_limit_no_pass_is_too_long(a_cycle):
    assert aged(a_cycle, 10**4, None).run(taken(1)).level is Level.CLEAR


def test_the_age_is_one_number_that_of_the_end(a_cycle):
    result = a_cycle.run(taken(2_000_000, 5_000_000))
    assert result.age_ms == result.oldest_age_ms + result.cycle_ms
    assert a_cycle.run(taken(None)).age_ms is None


def test_what_a_look_or_the_watch_found_does_not_hide_that_it_is_too_old(a_cycle):
    late = aged(a_cycle, 300).run(taken(10**9, now_ns=10**9)).knowing(health("camera c0 has turned"))
    assert {v.cause for v in late.verdicts} == {Cause.STALE} and late.stopped_by == late.late


def test_a_cycle_that_asks_nothing_is_refused():
    with pytest.raises(InputError, match="at least one"):
        Cycle(GRID, (), OneJoint(), ())


def test_a_result_keeps_images_only_where_somebody_asks_for_it(a_cycle, monkeypatch):
    with_images = replace(SPACE, source=object())
    monkeypatch.setattr(cycle, "free_space_of", lambda *_, **__: with_images)
    assert a_cycle.run(NOTHING).space.source is None
    a_cycle.keeps_images = True
    assert a_cycle.run(NOTHING).space.source is with_images.source


def health(reason: str) -> Known:
    return Known(Health((), (), {"c0": reason} if reason else {}), None, {"watch": 2.0})


def test_what_the_watch_found_stops_every_motion_and_is_no_fault(a_cycle):
    assert a_cycle.run(taken(1)).knowing(health("")).level is Level.CLEAR
    result = a_cycle.run(taken(1)).knowing(health("camera c0 has turned by 0.9 degrees"))
    assert [v.level for v in result.verdicts] == [Level.STOP] * 2
    assert all(v.free_travel == 0 and not v.overridable for v in result.verdicts)
    assert {v.cause for v in result.verdicts} == {Cause.WATCH}
    assert result.fault is None and result.stopped_by == "camera c0 has turned by 0.9 degrees"
    assert result.space is not None and list(result.stage_ms) == ["watch", "carve", "motion"]


def test_a_watch_that_failed_is_a_stop(a_cycle):
    result = a_cycle.run(taken(1)).knowing(Known(None, "InputError: no such image"))
    assert_all_stop(result, "no such image")
    assert result.stopped_by == result.fault


def test_a_fault_stays_a_fault_whatever_the_watch_says(a_cycle):
    result = a_cycle.run(NO_FRAMES_AT_ALL).knowing(health("camera c0 has turned"))
    assert_all_stop(result, "AttributeError")
    assert result.health.reason == "camera c0 has turned"


def test_nobody_watches_and_it_says_so(a_cycle):
    result = a_cycle.run(taken(1)).knowing(Known())
    assert result.health is None and result.stopped_by is None
