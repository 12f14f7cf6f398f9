"""The loop: every face is told of every pass and of the end, and whatever fails is a stop for all of them."""

import gc
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.errors import FrameError, InputError
from elbowroom.finding import Finding
from elbowroom.geometry import VoxelGrid
from elbowroom.monitor import Checks, Cycle, Health, Loop, Pass, cycle, loop
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.reconstruct import Terms
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.sources import Room

GRID = VoxelGrid(origin_m=(0, 0, 0), shape=(4, 4, 4), voxel_size_m=0.1)
SPACE = FreeSpace.from_occupied(GRID, np.zeros(GRID.shape, dtype=bool))
MOTION = Motion("slide", +1, 0.1)


class OneJoint:
    """As much of a machine as a pass asks for itself."""

    class _Slide:
        name, unit = "slide", "m"

    joints = (_Slide(),)


def at(now_ns: int) -> Snapshot:
    return Snapshot((DepthFrame("c0", now_ns, np.ones((2, 2), np.float32)),), {"slide": 0.0}, now_ns=now_ns)


class Script:
    """A source that gives what it is told to give, or raises it."""

    name = "script"

    def __init__(self, *steps: Snapshot | BaseException) -> None:
        self.steps = steps
        self.closed = 0

    def __iter__(self) -> Iterator[Snapshot]:
        for step in self.steps:
            if isinstance(step, BaseException):
                raise step
            yield step

    def close(self) -> None:
        self.closed += 1


class Listener:
    """A face that remembers what it was told, and raises at one pass if it is told to."""

    def __init__(self, fails_at: int | None = None, error: BaseException | None = None) -> None:
        self.fails_at, self.error = fails_at, error or OSError("disk full")
        self.begun: list[Room] = []
        self.shown: list[Pass] = []
        self.ended = 0

    def begin(self, room: Room) -> None:
        assert not self.shown
        self.begun.append(room)

    def show(self, done: Pass) -> None:
        self.shown.append(done)
        if len(self.shown) - 1 == self.fails_at:
            raise self.error

    def end(self) -> None:
        self.ended += 1

    @property
    def levels(self) -> list[Level]:
        return [done.result.level for done in self.shown]


class AWatch:
    """Says what it is told to say."""

    def __init__(self, *reasons: str | Exception) -> None:
        self.reasons = list(reasons)
        self.heard: list[list[str]] = []

    def hear(self, snapshot: Snapshot) -> Health:
        self.heard.append([frame.camera for frame in snapshot.frames])
        reason = self.reasons.pop(0)
        if isinstance(reason, Exception):
            raise reason
        return Health((), (), {"c0": reason} if reason else {})


@pytest.fixture(autouse=True)
def _all_is_clear(monkeypatch):
    """Both stages of a pass answer that all is free and clear."""
    clear = Verdict(MOTION, Level.CLEAR, 0.5, "m", None, None, Cause.NONE)
    monkeypatch.setattr(cycle, "free_space_of", lambda *_, **__: SPACE)
    monkeypatch.setattr(cycle, "check_motions", lambda *_: [clear])


def a_loop(source: Script, checks: Checks | None = None, pace=None) -> Loop:
    room = Room(None, GRID, (), OneJoint(), Terms(), source)
    return Loop(room, checks or Checks(), Cycle(GRID, (), OneJoint(), (MOTION,), focused=False), pace)


def test_every_face_is_told_of_the_room_of_every_pass_in_order_and_of_the_end():
    source, faces = Script(at(1), at(2), at(3)), (Listener(), Listener())
    loop = a_loop(source)
    loop.run(faces)
    for face in faces:
        assert face.begun == [loop.room]
        assert [done.snapshot.now_ns for done in face.shown] == [1, 2, 3]
        assert [done.result.sequence for done in face.shown] == [0, 1, 2]
        assert all(done.source_ms >= 0 for done in face.shown)
        assert face.levels == [Level.CLEAR] * 3 and face.ended == 1
    assert source.closed == 1


class GarbageWatcher(Listener):
    """Counts what collections leave alone and what they look through; each pass leaves it garbage that holds itself."""

    def show(self, done: Pass) -> None:
        super().show(done)
        self.left_alone, self.looked_through = gc.get_freeze_count(), len(gc.get_objects())
        ring: list[object] = []
        ring.append(ring)
        del ring
        self.collected = gc.collect()


def test_while_a_run_goes_on_collections_look_only_through_what_came_since():
    face, there = GarbageWatcher(), len(gc.get_objects())
    with pytest.raises(FrameError):
        a_loop(Script(at(1), FrameError("torn"))).run([face])
    assert face.left_alone > 0.9 * there
    assert face.looked_through < 0.1 * there
    assert face.collected > 0
    assert gc.get_freeze_count() == 0


def test_a_source_that_gives_nothing_ends_the_run_at_once():
    source, face = Script(), Listener()
    a_loop(source).run([face])
    assert (face.shown, face.ended, source.closed) == ([], 1, 1)


class Collecting:
    """A watch that notes whether garbage may be collected while it listens, and how much is never looked at."""

    def __init__(self) -> None:
        self.heard: list[tuple[bool, int]] = []

    def hear(self, snapshot: Snapshot) -> Health:
        self.heard.append((gc.isenabled(), gc.get_freeze_count()))
        if len(self.heard) == 2:
            raise RuntimeError("no such image")
        return Health((), (), {})


def test_no_garbage_is_collected_within_a_pass_and_what_was_there_before_is_not_looked_at():
    watch = Collecting()
    gc.enable()
    a_loop(Script(at(1), at(2), at(3)), Checks(watch)).run([Listener()])
    assert [may for may, _ in watch.heard] == [False] * 3
    assert all(frozen > 1000 for _, frozen in watch.heard)
    # afterwards it is as it was, also where a check raised
    assert gc.isenabled() and gc.get_freeze_count() == 0


def test_one_pass_is_made_however_short_the_time():
    face = Listener()
    a_loop(Script(at(1), at(2))).run([face], seconds=0.0)
    assert len(face.shown) == 1 and face.ended == 1


@pytest.mark.parametrize(
    "error", [FrameError("cam00 is torn"), RuntimeError("driver"), MemoryError("none left")]
)
def test_a_source_that_raises_is_a_stop_and_ends_the_run(error):
    source, face = Script(at(5), error), Listener()
    with pytest.raises(type(error), match=str(error)):
        a_loop(source).run([face])
    assert face.levels == [Level.CLEAR, Level.STOP] and face.ended == 1 and source.closed == 1
    last = face.shown[-1].result
    assert str(error) in last.fault and last.stamp_ns == 5
    assert {verdict.cause for verdict in last.verdicts} == {Cause.FAULT}


def test_a_source_that_raises_before_anything_came_is_a_stop_too():
    face = Listener()
    with pytest.raises(FrameError):
        a_loop(Script(FrameError("no camera"))).run([face])
    assert face.levels == [Level.STOP] and face.ended == 1


@pytest.mark.parametrize("failing", [0, 1, 2])
def test_a_face_that_raises_is_a_stop_for_all_the_others(failing):
    faces = [Listener(fails_at=1 if n == failing else None) for n in range(3)]
    source = Script(at(1), at(2), at(3))
    with pytest.raises(OSError, match="disk full"):
        a_loop(source).run(faces)
    assert all(face.levels[-1] is Level.STOP and face.ended == 1 for face in faces)
    assert all("disk full" in face.shown[-1].result.fault for face in faces)
    # those behind it did not hear of the pass that it failed at, only that all stops
    assert [len(face.shown) for face in faces] == [3 if n <= failing else 2 for n in range(3)]
    assert source.closed == 1


def test_a_face_that_always_raises_keeps_no_other_from_hearing_stop():
    class Broken(Listener):
        def show(self, done: Pass) -> None:
            raise OSError("gone")

    behind = Listener()
    with pytest.raises(OSError, match="gone"):
        a_loop(Script(at(1))).run([Broken(), behind])
    assert behind.levels == [Level.STOP] and behind.ended == 1


def test_a_face_that_cannot_begin_is_a_stop_too():
    class Absent(Listener):
        def begin(self, room: Room) -> None:
            raise OSError("no screen")

    source, behind = Script(at(1)), Listener()
    with pytest.raises(OSError, match="no screen"):
        a_loop(source).run([Absent(), behind])
    assert behind.levels == [Level.STOP] and behind.ended == 1 and source.closed == 1


def test_a_face_that_cannot_end_keeps_no_other_from_ending():
    class Stuck(Listener):
        def end(self) -> None:
            raise OSError("cannot close")

    source, behind = Script(at(1)), Listener()
    with pytest.raises(OSError, match="cannot close"):
        a_loop(source).run([Stuck(), behind])
    assert behind.ended == 1 and source.closed == 1


@pytest.mark.parametrize("where", ["source", "face"])
def test_ctrl_c_loses_no_pass_and_every_face_is_told_of_the_end(where):
    source = Script(at(1), at(2), KeyboardInterrupt()) if where == "source" else Script(at(1), at(2), at(3))
    faces = [Listener(), Listener(fails_at=1 if where == "face" else None, error=KeyboardInterrupt())]
    with pytest.raises(KeyboardInterrupt):
        a_loop(source).run(faces)
    assert [[done.snapshot.now_ns for done in face.shown] for face in faces] == [[1, 2], [1, 2]]
    assert [face.ended for face in faces] == [1, 1] and source.closed == 1


def test_what_the_watch_found_stops_the_pass_and_the_run_goes_on():
    face = Listener()
    checks = Checks(AWatch("", "camera c0 has turned by 0.9 degrees", ""))
    a_loop(Script(at(1), at(2), at(3)), checks).run([face])
    assert face.levels == [Level.CLEAR, Level.STOP, Level.CLEAR]
    found = face.shown[1].result
    assert found.verdicts[0].cause is Cause.WATCH and found.fault is None
    assert list(found.stage_ms) == ["watch", "motion"]


def test_a_watch_that_raises_is_a_stop_with_its_reason_and_the_run_goes_on():
    face = Listener()
    a_loop(Script(at(1), at(2)), Checks(AWatch(RuntimeError("no such image"), ""))).run([face])
    assert face.levels == [Level.STOP, Level.CLEAR]
    failed = face.shown[0].result
    assert failed.fault == failed.stopped_by == "RuntimeError: no such image"
    assert failed.verdicts[0].cause is Cause.FAULT and failed.health is None


class ALook:
    """Finds the same at every moment."""

    name = "look"

    def __init__(self, *findings):
        self.findings = findings

    def hear(self, snapshot):
        return self.findings


def test_what_a_look_finds_stops_every_motion_if_it_says_so_and_is_told_either_way():
    mild = Finding("unit", ("c0",), "camera c0: odd", False)
    grave = Finding("pose", ("c1",), "camera c1: turned over", True)
    for findings, level, words in (((mild,), Level.CLEAR, None), ((mild, grave), Level.STOP, grave.text)):
        face = Listener()
        a_loop(Script(at(1)), Checks(looks=(ALook(*findings),))).run([face])
        result = face.shown[0].result
        assert (result.level, result.stopped_by, result.fault) == (level, words, None)
        assert result.findings == findings and "look" in result.stage_ms
    assert result.verdicts[0].cause is Cause.INPUT


def test_the_watch_hears_no_frame_past_its_age():
    image = np.ones((2, 2), np.float32)
    frames = [DepthFrame(f"c{n}", stamp, image) for n, stamp in enumerate((0, 8, None))]
    watch = AWatch("")
    Checks(watch, max_age_ns=5).hear(Snapshot.taken(frames, None, 10))
    assert watch.heard == [["c1"]]


def test_an_age_limit_where_nothing_has_a_time_is_a_fault():
    known = Checks(AWatch(""), max_age_ns=5).hear(Snapshot(()))
    assert "an age limit needs the time" in known.fault and known.stop_cause is Cause.FAULT


@pytest.fixture
def sleeps(monkeypatch):
    """A clock that only sleeping moves, and what was slept."""

    class Clock:
        now_s, slept = 100.0, []

        def perf_counter(self):
            return self.now_s

        def perf_counter_ns(self):
            return round(self.now_s * 1e9)

        def sleep(self, seconds):
            self.now_s += seconds
            self.slept.append(seconds)

    made = Clock()
    made.slept = []
    monkeypatch.setattr(loop, "time", made)
    return made


def test_the_end_comes_also_while_a_snapshot_is_waited_for(sleeps):
    face, source = Listener(), Script(at(1), at(2), at(3))
    a_loop(source, pace=lambda snapshot: 3600.0 if snapshot.now_ns == 2 else 0.0).run([face], seconds=5.0)
    assert [done.snapshot.now_ns for done in face.shown] == [1]
    assert sum(sleeps.slept) == pytest.approx(5.0)
    assert face.ended == 1 and source.closed == 1


def test_a_snapshot_that_comes_before_the_end_is_waited_for_and_judged(sleeps):
    face = Listener()
    a_loop(Script(at(1), at(2), at(3)), pace=lambda snapshot: 0.5).run([face], seconds=1.2)
    assert [done.snapshot.now_ns for done in face.shown] == [1, 2]
    assert sum(sleeps.slept) == pytest.approx(1.2)


def test_who_asks_for_the_end_is_heard_after_a_pass_and_in_a_wait(sleeps):
    face, source = Listener(), Script(at(1), at(2), at(3))
    a_loop(source).run([face], is_over=lambda: len(face.shown) == 2)
    assert [done.snapshot.now_ns for done in face.shown] == [1, 2] and face.ended == 1 and source.closed == 1
    waiting = Listener()
    a_loop(Script(at(1), at(2)), pace=lambda snapshot: 3600.0 if snapshot.now_ns == 2 else 0.0).run(
        [waiting], is_over=lambda: sum(sleeps.slept) > 1.0
    )
    assert [done.snapshot.now_ns for done in waiting.shown] == [1] and sum(sleeps.slept) < 1.5


def test_ctrl_c_ends_a_wait(sleeps, monkeypatch):
    def interrupted(seconds):
        raise KeyboardInterrupt

    monkeypatch.setattr(sleeps, "sleep", interrupted)
    face, source = Listener(), Script(at(1), at(2))
    with pytest.raises(KeyboardInterrupt):
        a_loop(source, pace=lambda snapshot: 3600.0).run([face])
    assert face.ended == 1 and source.closed == 1


def test_the_time_of_the_checks_counts_for_the_age_of_what_was_seen():
    ticks = [0, 250_000_000]
    looped = a_loop(Script(at(1)), Checks(AWatch("")))
    looped.cycle.terms = Terms(max_age_ns=200_000_000)
    looped.cycle.clock_ns = lambda: ticks.pop(0)
    face = Listener()
    looped.run([face])
    assert face.shown[0].result.verdicts[0].cause is Cause.STALE and ticks == []


def test_each_snapshot_waits_for_its_time_before_it_is_judged():
    told: list[int] = []
    face = Listener()
    a_loop(
        Script(at(1), at(2)), pace=lambda snapshot: told.append(snapshot.now_ns + 10 * len(face.shown))
    ).run([face])
    assert told == [1, 12]


# the gate


class AGate:
    """Notes in one list what it is told, as the faces beside it do."""

    def __init__(self, told: list[str], refuses: bool = False) -> None:
        self.told, self.refuses = told, refuses
        self.faults: list[str | None] = []

    def begin(self) -> None:
        if self.refuses:
            raise InputError("another monitor runs with this gate")
        self.told.append("gate begins")

    def decide(self, result):
        self.told.append("gate decides")
        self.faults.append(result.fault)
        return f"decision {len(self.faults)}"

    def end(self) -> None:
        self.told.append("gate ends")


class Noting(Listener):
    """A face that notes its order beside the gate."""

    def __init__(self, told: list[str], fails_at: int | None = None) -> None:
        super().__init__(fails_at)
        self.told = told

    def show(self, done: Pass) -> None:
        self.told.append(f"face shows {done.decision}")
        super().show(done)

    def end(self) -> None:
        self.told.append("face ends")
        super().end()


def test_the_gate_decides_before_any_face_and_ends_before_them():
    told: list[str] = []
    replace(a_loop(Script(at(1), at(2))), gate=AGate(told)).run([Noting(told)])
    assert told == [
        "gate begins",
        "gate decides",
        "face shows decision 1",
        "gate decides",
        "face shows decision 2",
        "gate ends",
        "face ends",
    ]


def test_a_run_that_fails_is_a_fault_for_the_gate():
    told: list[str] = []
    gate = AGate(told)
    with pytest.raises(OSError, match="disk full"):
        replace(a_loop(Script(at(1), at(2))), gate=gate).run([Noting(told, fails_at=0)])
    assert gate.faults[0] is None and "disk full" in gate.faults[1]
    assert told[-3:] == ["face shows decision 2", "gate ends", "face ends"]


def test_a_gate_that_cannot_begin_begins_nothing():
    told: list[str] = []
    face = Noting(told)
    with pytest.raises(InputError, match="another monitor"):
        replace(a_loop(Script(at(1))), gate=AGate(told, refuses=True)).run([face])
    assert told == [] and face.begun == []


def test_without_a_gate_there_is_no_decision():
    face = Listener()
    a_loop(Script(at(1))).run([face])
    assert face.shown[0].decision is None


@pytest.mark.parametrize("where", ["cycle", "watch"])
def test_an_interrupt_inside_compiled_code_ends_the_run_and_is_no_fault(where, monkeypatch):
    wrapped = SystemError("returned a result with an exception set")
    wrapped.__cause__ = KeyboardInterrupt()

    def interrupted(*_, **__):
        raise wrapped

    checks = None
    if where == "cycle":
        monkeypatch.setattr(cycle, "check_motions", interrupted)
    else:
        checks = Checks(AWatch(wrapped))
    told: list[str] = []
    gate = AGate(told)
    with pytest.raises(KeyboardInterrupt):
        replace(a_loop(Script(at(1), at(2)), checks), gate=gate).run([Listener()])
    assert gate.faults == [] and told == ["gate begins", "gate ends"]
