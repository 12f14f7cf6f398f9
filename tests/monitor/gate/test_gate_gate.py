"""The gate of a run: what passes, faults, resets, disks and watchdogs make of it, and what is left on disk."""

import errno
import json
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from elbowroom.errors import InputError
from elbowroom.files import durable
from elbowroom.finding import Finding
from elbowroom.guard.control import ask, hold
from elbowroom.guard.fault import Fault
from elbowroom.guard.heartbeat import Heartbeat
from elbowroom.guard.latch import Mark, read_latch, write_latch
from elbowroom.guard.link import WatchdogLink
from elbowroom.guard.reason import Reason
from elbowroom.monitor import CycleResult, Health
from elbowroom.monitor.gate.claim import Claim, speed_of
from elbowroom.monitor.gate.faults import faults_of
from elbowroom.monitor.gate.gate import Gate
from elbowroom.monitor.gate.state import Phase, Rules
from elbowroom.monitor.gate.told import GateRows, gate_lines
from elbowroom.monitor.health.streams.cause import HealthCause, Sick
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.motion.verdict import Creep

MOTIONS = (Motion("slide", +1, 0.1), Motion("slide", -1, 0.1))
RULES = Rules(tuple(motion.name for motion in MOTIONS))
SITE = "cell"
STEP_NS = 100_000_000


class Clock:
    """A clock that goes on when it is told to, from what it is now."""

    def __init__(self) -> None:
        self.now_ns = time.monotonic_ns()

    def __call__(self) -> int:
        return self.now_ns


class Told(WatchdogLink):
    """Takes heartbeats for the watchdog."""

    def __init__(self, *wrong: Fault) -> None:
        super().__init__({})
        self.beats: list[Heartbeat] = []
        self.wrong = list(wrong)

    def begin(self) -> None:
        assert not self.beats

    def send(self, heartbeat: Heartbeat) -> None:
        self.beats.append(heartbeat)

    def faults(self) -> list[Fault]:
        return list(self.wrong)

    def end(self) -> None:
        assert self.beats[-1].is_last


def verdict(motion: Motion, travel: float = 0.6, cause: Cause = Cause.NONE) -> Verdict:
    level = Level.at(travel, motion.braking_distance)
    return Verdict(motion, level, travel, "m", None, None, cause)


def result(sequence: int = 1, **wrong: Any) -> CycleResult:
    verdicts = wrong.pop("verdicts", tuple(verdict(motion) for motion in MOTIONS))
    return CycleResult(sequence, 0, None, verdicts, {}, None, **wrong)


class Run:
    """A gate that began in a folder, and a clock that goes on by 100 ms a pass."""

    def __init__(self, folder: Path, *wrong: Fault, site: str = SITE) -> None:
        self.clock, self.told, self.sequence = Clock(), Told(*wrong), 0
        self.folder = folder
        self.gate = Gate(folder, site, RULES, self.told, self.clock)
        self.gate.begin()
        self.is_over = False

    def kill(self) -> None:
        """Leaves what the system leaves of a process that is killed."""
        self.is_over = True
        self.gate._control._listener.close()
        self.gate._let_go()

    def end(self) -> None:
        if not self.is_over:
            self.is_over = True
            self.gate.end()

    def passes(self, count: int = 1, **wrong: Any) -> Any:
        for _ in range(count):
            self.clock.now_ns += STEP_NS
            self.sequence += 1
            decision = self.gate.decide(result(self.sequence, **wrong))
        return decision

    def asked(self, request: Callable[[], Any], **wrong: Any) -> Any:
        """What is answered to one who asks while passes go on."""
        answers: list[Any] = []
        thread = threading.Thread(target=lambda: answers.append(request()))
        thread.start()
        end = time.monotonic() + 3
        while not answers and time.monotonic() < end:
            self.passes(**wrong)
            time.sleep(0.002)
        thread.join()
        return answers[0]

    def reset(self, **wrong: Any) -> Any:
        return self.asked(lambda: ask(self.folder, "reset"), **wrong)

    @property
    def on_disk(self) -> list[Reason]:
        return [fault.reason for fault in read_latch(self.folder / "latch", SITE).faults]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Of a gate whose last run has ended as it was asked to."""
    write_latch(tmp_path / "latch", SITE, Mark.ENDED)
    return tmp_path


Begin = Callable[..., Run]


@pytest.fixture
def begin(folder: Path) -> Iterator[Begin]:
    """begin() starts a run in the folder; what still runs at the end is ended."""
    runs: list[Run] = []

    def begun(*wrong: Fault, site: str = SITE) -> Run:
        runs.append(Run(folder, *wrong, site=site))
        return runs[-1]

    yield begun
    for run in runs:
        run.end()


@pytest.fixture
def run(begin: Begin) -> Run:
    return begin()


def test_whole_passes_let_the_machine_go_slowly(run: Run) -> None:
    assert run.passes().speed == 0
    assert run.passes().speed == pytest.approx(0.05)
    assert run.passes(25).speed == 1
    assert [beat.machine.per_mille for beat in run.told.beats[:3]] == [0, 50, 100]
    assert run.told.beats[-1].machine.level == Level.CLEAR.rank
    sequences = [beat.sequence for beat in run.told.beats]
    assert sequences == sorted(set(sequences))


FAULTS = {
    "fault": ({"fault": "KeyError: 'x'"}, Reason.FAULT),
    "late": ({"late": "too old"}, Reason.STALE),
    "input": ({"findings": (Finding("unit", ("cam1",), "millimetres", True),)}, Reason.INPUT),
    "watch": ({"health": Health((), (), {"cam1": "camera cam1 has moved"})}, Reason.WATCH),
    "missing": ({"verdicts": (verdict(MOTIONS[0]),)}, Reason.FAULT),
    "none": ({"verdicts": ()}, Reason.FAULT),
    "nan": (
        {"verdicts": (replace(verdict(MOTIONS[0]), free_travel=float("nan")), verdict(MOTIONS[1]))},
        Reason.FAULT,
    ),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_every_fault_of_a_pass_stops_at_once_latches_and_is_on_disk(run: Run, kind: str) -> None:
    wrong, reason = FAULTS[kind]
    run.passes(5)
    decision = run.passes(**wrong)
    assert decision.level is Level.STOP and decision.reason is reason
    assert run.told.beats[-1].machine.per_mille == 0
    assert run.on_disk == [reason]
    decision = run.passes(30)
    assert decision.phase is Phase.CLEARED and decision.speed == 0


def test_warnings_latch_nothing(run: Run) -> None:
    finding = Finding("mask", ("cam1",), "returns in masked pixels", False)
    assert run.passes(30, findings=(finding,)).phase is Phase.GUARDING


def test_latch_outlives_kill_and_restart(begin: Begin) -> None:
    killed = begin()
    killed.passes(3)
    killed.passes(late="too old")
    killed.kill()
    again = begin()
    decision = again.passes(30)
    assert decision.phase is Phase.CLEARED and decision.speed == 0
    assert [fault.sentence for fault in decision.latched] == ["too old"]
    again.end()
    third = begin()
    assert third.passes(30).phase is Phase.CLEARED
    assert third.reset()["reset"]
    assert third.passes(30).speed == 1
    third.end()
    assert begin().passes(30).speed == 1


def test_kill_without_a_fault_is_latched(begin: Begin) -> None:
    killed = begin()
    killed.passes(3)
    killed.kill()
    decision = begin().passes(30)
    assert [fault.reason for fault in decision.latched] == [Reason.UNCLEAN_END]


def test_reset_is_refused_while_a_cause_is_there(run: Run) -> None:
    run.passes(3)
    answer = run.reset(late="too old")
    assert not answer["reset"] and answer["answer"] == "refused: what stopped is still there: too old"
    assert run.on_disk == [Reason.STALE]


def test_reset_moves_nothing_and_is_on_disk(run: Run) -> None:
    run.passes(3)
    run.passes(late="too old")
    answer = run.reset()
    assert answer["reset"] and answer["level"] == "stop"
    assert run.on_disk == [Reason.UNCLEAN_END]  # which is latched: a kill now is no reset
    speeds = [beat.machine.per_mille for beat in run.told.beats]
    after = speeds[len(speeds) - speeds[::-1].index(0) :]
    assert after == sorted(after) and all(speed <= 50 * (1 + n) for n, speed in enumerate(after))


def test_only_status_reset_and_hold_can_be_asked(run: Run) -> None:
    assert "refused" in run.asked(lambda: ask(run.folder, "go"))["answer"]
    status = run.asked(lambda: ask(run.folder, "status"))
    assert status["site"] == SITE and set(status["motions"]) == set(RULES.motions)


def test_hold_counts_if_it_is_of_now(run: Run) -> None:
    creep = Creep(0.1, 0.05, 0.2, Cause.NONE)
    unseen = tuple(replace(verdict(motion, 0.01, Cause.UNSEEN), creep=creep) for motion in MOTIONS)
    run.gate.clock_ns = time.monotonic_ns
    run.gate.rules = replace(RULES, deadline_ns=10**10)
    run.passes(3, verdicts=unseen)
    assert not run.asked(lambda: ask(run.folder, "hold 5"), verdicts=unseen)["held"]
    for wrong in ("hold", "hold -1", "hold x", f"hold {time.monotonic_ns() + 10**12}"):
        assert not run.asked(lambda wrong=wrong: ask(run.folder, wrong), verdicts=unseen)["held"]
    assert run.passes(verdicts=unseen).motions[0].speed == 0
    assert run.asked(lambda: hold(run.folder), verdicts=unseen)["held"]
    time.sleep(0.05)
    assert run.passes(verdicts=unseen).motions[0].held
    time.sleep(0.21)
    assert run.passes(verdicts=unseen).motions[0].speed == 0


@pytest.mark.parametrize("call", ["write", "fsync"])
def test_full_disk_while_latching_is_stop_and_said(
    run: Run, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    run.passes(10)

    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(durable.os, call, full)
        decision = run.passes(late="too old")
        assert decision.level is Level.STOP
        assert [fault.reason for fault in decision.active] == [Reason.STALE, Reason.LATCH_FILE]
        decision = run.passes(20)
        assert "No space left" in "".join(gate_lines(decision))
        assert not run.reset()["reset"]
    run.passes(12)
    assert run.on_disk == [Reason.STALE, Reason.LATCH_FILE]
    assert run.reset()["reset"]


def test_run_that_cannot_write_at_its_start_stands(
    begin: Begin, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(durable.os, "fsync", full)
        run = begin()
        assert {run.passes().speed for _ in range(30)} == {0}
        run.end()
    assert read_latch(folder / "latch", SITE).faults == ()  # nothing moved, so nothing is to be told


def test_latch_of_another_site_stops_and_is_left(begin: Begin, folder: Path) -> None:
    content = (folder / "latch").read_bytes()
    other = begin(site="another")
    decision = other.passes(30)
    assert decision.speed == 0 and decision.active[0].reason is Reason.LATCH_FILE
    assert not other.reset()["reset"]
    other.end()
    assert (folder / "latch").read_bytes() == content


def test_what_is_wrong_with_the_watchdog_latches(run: Run) -> None:
    run.passes(10)
    run.told.wrong = [Fault(Reason.WATCHDOG, "", "the watchdog has ended")]
    assert run.passes().level is Level.STOP
    run.told.wrong = []
    assert run.passes(10).phase is Phase.CLEARED


def test_whatever_fails_in_the_gate_is_stop(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    run.passes(10)

    def broken(*_: object) -> None:
        raise ZeroDivisionError("nobody thought of this")

    monkeypatch.setattr("elbowroom.monitor.gate.gate.faults_of", broken)
    decision = run.passes()
    assert decision.level is Level.STOP
    assert "nobody thought of this" in decision.active[0].sentence
    assert run.told.beats[-1].machine.per_mille == 0


def test_a_run_whose_stop_could_not_be_latched_has_not_ended_well(
    begin: Begin, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Short of memory, for one: the gate itself fails, twice, and the run ends by that error."""
    run = begin()
    run.passes()

    def fails() -> list[Fault]:
        raise MemoryError

    monkeypatch.setattr(run.told, "faults", fails)
    with pytest.raises(MemoryError):
        run.passes()
    run.end()
    assert run.on_disk == [Reason.UNCLEAN_END]
    assert begin().passes().latched[0].reason is Reason.UNCLEAN_END


def test_two_monitors_cannot_share_a_folder(run: Run) -> None:
    with pytest.raises(InputError, match="another monitor"):
        Gate(run.folder, SITE, RULES).begin()
    assert run.asked(lambda: ask(run.folder, "status"))["site"] == SITE


def test_folder_that_cannot_be_made_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="is no folder"):
        Gate(tmp_path / "file", SITE, RULES).begin()


def test_end_is_a_stop_for_the_watchdog(run: Run, folder: Path) -> None:
    run.passes(30)
    run.end()
    assert run.told.beats[-1].is_last and run.told.beats[-1].machine.per_mille == 0
    assert sorted(path.name for path in folder.iterdir()) == ["latch", "lock"]


# claims


@pytest.mark.parametrize(
    ("travel", "speed"), [(0.0, 0), (0.1, 0), (0.125, 0.25), (0.2, 1), (0.3, 1), (0.5, 1), (0.9, 1)]
)
def test_speed_is_the_one_that_rests_a_braking_distance_before_the_block(travel: float, speed: float) -> None:
    assert speed_of(verdict(MOTIONS[0], travel)) == pytest.approx(speed)


def test_speed_of_stop_is_zero_whatever_the_travel() -> None:
    stop = Verdict.stop(MOTIONS[0], "m", Cause.WATCH)
    assert speed_of(replace(stop, free_travel=5.0)) == 0


def test_every_cause_of_a_verdict_is_a_reason() -> None:
    for cause in Cause:
        claim = Claim.of(Verdict.stop(MOTIONS[0], "m", cause), 0.1)
        assert claim.reason is Reason[cause.name]
        assert claim.reason.is_fault == (cause in (Cause.FAULT, Cause.STALE, Cause.INPUT, Cause.WATCH))
        assert not claim.overridable  # nobody says how far one may creep


def test_escape_needs_room_to_brake_at_low_speed() -> None:
    near, far = (verdict(MOTIONS[0], travel, Cause.SURFACE) for travel in (0.0099, 0.0101))
    assert not Claim.of(replace(near, escapes=True), 0.1).escapes
    assert Claim.of(replace(far, escapes=True), 0.1).escapes
    assert not Claim.of(far, 0.1).escapes
    stop = replace(Verdict.stop(MOTIONS[0], "m", Cause.INPUT), escapes=True)
    assert not Claim.of(stop, 0.1).escapes


@pytest.mark.parametrize("cause", Cause)
def test_override_goes_where_the_verdict_says_how_far_and_no_faster(cause: Cause) -> None:
    creep = Creep(0.02, 0.004, 0.03, Cause.SURFACE)
    stop = replace(verdict(MOTIONS[0], 0.01, cause), creep=creep)
    claim = Claim.of(stop, 0.1)
    assert claim.overridable == (cause is Cause.UNSEEN)
    assert claim.creep_speed == pytest.approx(0.04)
    assert not Claim.of(replace(stop, creep=replace(creep, travel=0.0)), 0.1).overridable
    assert not Claim.of(replace(stop, level=Level.DECELERATE), 0.1).overridable


# rows and lines


def test_rows_say_what_is_news_and_what_is_latched_each_second(run: Run) -> None:
    now_s = 0.0
    rows = GateRows(lambda: now_s)
    told = []
    for late in (None, None, "too old", "too old"):
        now_s += 0.1
        told.append(rows.rows(result(), run.passes(late=late)))
    assert [len(each) for each in told] == [1, 1, 1, 0]
    now_s += 1.0
    (row,) = rows.rows(result(), run.passes(late="too old"))
    assert row["kind"] == "gate" and row["phase"] == "latched" and row["active"][0]["text"] == "too old"
    assert json.dumps(row)
    assert rows.rows(result(), None) == []


def test_lines_name_what_is_there_and_what_is_over(run: Run) -> None:
    assert "100 % of full speed" in gate_lines(run.passes(30))[0]
    assert gate_lines(run.passes(late="too old")) == ["Gate: stop, latched: too old"]
    assert gate_lines(run.passes()) == ["Gate: stop until reset, this is over: too old"]


def test_faults_of_one_camera_are_one_fault() -> None:
    moved = Health((), (), {"cam1": "camera cam1 has moved by 1°"})
    more = Health((), (), {"cam1": "camera cam1 has moved by 2°", "cam2": "covered"})
    assert faults_of(result(health=moved))[0] == faults_of(result(health=more))[0]
    assert len(faults_of(result(health=more))) == 2


CAMERAS = [cause for cause in HealthCause if cause.is_of_camera and cause.latches]


@pytest.mark.parametrize("cause", [cause for cause in HealthCause if cause.latches])
def test_every_cause_of_a_sick_source_latches_by_its_own_reason(run: Run, cause: HealthCause) -> None:
    run.passes(3)
    sick = Sick(cause, "cam1", "camera cam1 is not well", "3 images")
    decision = run.passes(sick=(sick,))
    assert (
        decision.level is Level.STOP
        and decision.reason is Reason[cause.name]
        and run.on_disk == [cause.value]
    )
    assert decision.latched[0].subject == "cam1" and decision.latched[0].sentence == sick.text
    assert run.passes().reason is Reason.RESET_DUE
    # one camera is left out, and what is judged holds; without joints nothing does
    assert cause.value.leaves_doubt is not cause.is_of_camera


@pytest.mark.parametrize("cause", CAMERAS)
def test_a_camera_that_the_site_can_do_without_latches_nothing(run: Run, cause: HealthCause) -> None:
    decision = run.passes(20, sick=(Sick(cause, "cam1", "", "", tolerated=True),))
    assert not decision.latched and decision.speed > 0


def test_nothing_moves_while_a_camera_has_not_given_its_first_image(run: Run) -> None:
    awaited = Sick(HealthCause.CAMERA_STARTING, "cam1", "camera cam1 is awaited", "its first image")
    decision = run.passes(5, sick=(awaited,))
    assert decision.level is Level.STOP and decision.reason is Reason.STARTING and not decision.latched
    assert run.passes(5).speed > 0


def test_nothing_moves_while_a_camera_may_be_elsewhere_and_nothing_latches(run: Run) -> None:
    assert run.passes(5).speed > 0
    doubted = Sick(HealthCause.CAMERA_DOUBTED, "cam1", "camera cam1 may be elsewhere", "the next images")
    decision = run.passes(1, sick=(doubted,))
    assert decision.speed == 0 and decision.reason is Reason.CAMERA_DOUBTED and not decision.latched
    assert doubted.leaves_out and not doubted.stops and not doubted.latches
    assert run.passes(5).speed > 0
