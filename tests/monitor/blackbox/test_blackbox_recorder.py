"""The recorder: it keeps all that it can, never makes the run wait, and says what it could not keep."""

import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from elbowroom.errors import InputError
from elbowroom.guard.fault import Fault
from elbowroom.guard.reason import Reason
from elbowroom.monitor import CycleResult, Decision, Loop, Pass
from elbowroom.monitor.blackbox import recorder as recorder_file
from elbowroom.monitor.blackbox.behind import BehindFile
from elbowroom.monitor.blackbox.kept_pass import KeptPass
from elbowroom.monitor.blackbox.made import recorder_of
from elbowroom.monitor.blackbox.pass_file import Head, PassFile
from elbowroom.monitor.blackbox.recorder import Recorder, require_new
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.monitor.blackbox.sinks import BlackBox, WholeRun
from elbowroom.monitor.blackbox.stops import Stops
from elbowroom.monitor.gate.state import Allowed, Phase
from elbowroom.motion import Cause, Level, Motion, Verdict
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.site import Site
from elbowroom.sources import Room, open_room
from elbowroom.wire.mcap_writer import Told
from elbowroom.wire.ros_schemas import SCHEMAS
from reference.small_room import SMALL_ROOM

MOTION = Motion("long", 1, 0.1)
STEP_NS = 100_000_000


@pytest.fixture
def room(tmp_path: Path) -> Room:
    (tmp_path / "room.yaml").write_text(SMALL_ROOM)
    return open_room(Site.load(tmp_path / "room.yaml"))


def a_pass(number: int, level: Level = Level.CLEAR, frames=None, **more) -> Pass:
    if frames is None:
        image = np.full((36, 48), 1.0 + number / 1000, np.float32)
        frames = [DepthFrame(f"cam{n:02d}", number * STEP_NS, image) for n in range(2)]
    cause = Cause.SURFACE if level is Level.STOP else Cause.NONE
    verdict = Verdict(MOTION, level, 0.1, "m", None, None, cause)
    result = CycleResult(number, number * STEP_NS, None, (verdict,), {"carve": 1.0}, 0.0, **more)
    return Pass(Snapshot(tuple(frames), {"long": 0.1}, now_ns=number * STEP_NS), result, 0.0)


def kept_in(path: Path) -> list[int]:
    with Recording(path) as recording:
        assert recording.wrong() is None
        return [one.sequence for one in recording.passes()]


def run(sinks, room: Room, passes) -> Recorder:
    recorder = Recorder(sinks)
    recorder.begin(room)
    for one in passes:
        recorder.show(one)
    recorder.end()
    return recorder


class HeldUp(WholeRun):
    """A file on a disk that does not answer until it is let go."""

    def __init__(self, path):
        super().__init__(path)
        self.gate = threading.Event()

    def take(self, one):
        self.gate.wait(30)
        super().take(one)


def test_all_passes_are_kept_as_they_were(room, tmp_path):
    shown = [a_pass(number) for number in range(9)]
    recorder = run([WholeRun(tmp_path / "run.mcap")], room, shown)
    assert recorder.troubles == [] and len(recorder.said) == 1
    with Recording(tmp_path / "run.mcap") as recording:
        assert recording.note is None and recording.wrong() is None
        for one, due in zip(recording.passes(), shown, strict=True):
            assert one.snapshot.joints == due.snapshot.joints
            assert one.snapshot.now_ns == due.snapshot.now_ns
            for frame, given in zip(one.snapshot.frames, due.snapshot.frames, strict=True):
                assert (frame.camera, frame.stamp_ns) == (given.camera, given.stamp_ns)
                assert frame.depth_m.tobytes() == given.depth_m.tobytes()
        configuration = recording.configuration()
        assert configuration.site_text.decode() == SMALL_ROOM
        assert configuration.told["site"] == "small room" and configuration.told["processor"]


def test_a_frame_that_comes_again_is_written_once_and_is_in_each_pass(room, tmp_path):
    still = DepthFrame("cam00", 5, np.random.default_rng(1).random((480, 640), np.float32) + 1)
    passes = [a_pass(number, frames=[still]) for number in range(20)]
    run([WholeRun(tmp_path / "run.mcap")], room, passes)
    assert (tmp_path / "run.mcap").stat().st_size < 2 * 4 * 640 * 480
    with Recording(tmp_path / "run.mcap") as recording:
        assert recording.at(19).snapshot.frames[0].depth_m.tobytes() == still.depth_m.tobytes()


def test_who_shows_a_pass_never_waits_and_what_is_lost_is_said(room, tmp_path):
    sink = HeldUp(tmp_path / "run.mcap")
    recorder = Recorder([sink], most_bytes=4 * 48 * 36 * 8)
    recorder.begin(room)
    begun = time.monotonic()
    for number in range(60):
        recorder.show(a_pass(number))
    assert time.monotonic() - begun < 5.0
    assert recorder.lost > 30
    (finding,) = recorder.hear(Snapshot(()))
    assert f"{recorder.lost} passes were not kept" in finding.text and not finding.stops
    sink.gate.set()
    for last in range(60, 260):
        lost = recorder.lost
        recorder.show(a_pass(last))
        if recorder.lost == lost:
            break
        time.sleep(0.05)
    recorder.end()
    kept = kept_in(tmp_path / "run.mcap")
    assert len(kept) == last + 1 - recorder.lost and kept[-1] == last
    with Recording(tmp_path / "run.mcap") as recording:
        assert sum(recording.at(number).lost for number in range(len(kept))) == recorder.lost


def test_a_disk_that_stalls_loses_nothing_while_what_is_packed_has_room(room, tmp_path, monkeypatch):
    """Longer than the queue of images lasts, which is of four passes here."""
    add, stalls = PassFile.add, threading.Event()

    def stalling(self, one):
        stalls.wait(30)
        add(self, one)

    monkeypatch.setattr(PassFile, "add", stalling)
    recorder = Recorder([WholeRun(tmp_path / "run.mcap")], most_bytes=4 * 4 * 48 * 36 * 8)
    recorder.begin(room)
    for number in range(40):
        recorder.show(a_pass(number))
        until = time.monotonic() + 5
        while recorder._queue and time.monotonic() < until:
            time.sleep(0.005)
    assert recorder.lost == 0 and not recorder.troubles
    stalls.set()
    recorder.end()
    assert kept_in(tmp_path / "run.mcap") == list(range(40))


def test_where_nothing_more_may_wait_for_the_disk_who_packs_waits_and_the_order_stays(tmp_path, monkeypatch):
    add, begun, stalls, written = PassFile.add, threading.Event(), threading.Event(), []

    def stalling(self, one):
        begun.set()
        stalls.wait(30)
        written.append(one.sequence)
        add(self, one)

    monkeypatch.setattr(PassFile, "add", stalling)
    told = Told("/x", next(iter(SCHEMAS)), bytes(1000))
    file = BehindFile(tmp_path / "run.mcap", Head([], []), most_bytes=3000)
    passes = [KeptPass(n, n, n, n, (), (told,), ()) for n in range(9)]
    adding = threading.Thread(target=lambda: [file.add(one) for one in passes])
    adding.start()
    assert begun.wait(10)
    adding.join(0.3)
    assert adding.is_alive() and len(file._queue) == 3
    stalls.set()
    adding.join(10)
    assert "9 passes" in file.end() and written == list(range(9)) and file.busy_ns > 0


class DiskUsage(NamedTuple):
    total: int
    used: int
    free: int


@pytest.fixture
def full_disk(monkeypatch):
    """A disk that is full from a number of passes on."""

    def begin(after: int) -> None:
        add = PassFile.add

        def full(self, one):
            if self.passes >= after:
                self._writer.drop()
                raise OSError(28, "No space left on device")
            add(self, one)

        monkeypatch.setattr(PassFile, "add", full)

    return begin


def test_a_full_disk_is_said_and_what_was_written_can_be_read(room, tmp_path, full_disk):
    full_disk(4)
    recorder = run([WholeRun(tmp_path / "run.mcap")], room, map(a_pass, range(9)))
    (trouble,) = recorder.troubles
    assert "No space left on device" in trouble and "after 4 passes" in trouble
    assert kept_in(tmp_path / "run.mcap") == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("total", "free", "is_kept"),
    [(1e12, 1.1e9, True), (1e12, 0.9e9, False), (1e6, 0.06e6, True), (1e6, 0.04e6, False)],
)
def test_a_disk_is_not_filled(room, tmp_path, monkeypatch, total, free, is_kept):
    """What is left is for others: the latch of a gate was refused on a disk that the black box had filled."""
    disk = DiskUsage(int(total), int(total - free), int(free))
    monkeypatch.setattr("elbowroom.monitor.blackbox.pass_file.shutil.disk_usage", lambda path: disk)
    recorder = run([WholeRun(tmp_path / "run.mcap")], room, map(a_pass, range(3)))
    assert kept_in(tmp_path / "run.mcap") == ([0, 1, 2] if is_kept else [])
    assert [words for words in recorder.troubles if "are left to others" in words] == recorder.troubles
    assert (recorder.troubles == []) is is_kept


def test_a_full_disk_does_not_end_the_run_and_is_in_its_findings(room, tmp_path, full_disk):
    full_disk(2)
    recorder = Recorder([WholeRun(tmp_path / "run.mcap")])
    recorder.begin(room)
    for number in range(4):
        recorder.show(a_pass(number))
    until = time.monotonic() + 20
    while not recorder.troubles and time.monotonic() < until:
        time.sleep(0.01)
    assert [finding.kind for finding in recorder.hear(Snapshot(()))] == ["recording"]
    recorder.end()


def test_whatever_fails_in_its_thread_is_said(room, tmp_path, monkeypatch):
    monkeypatch.setattr(recorder_file.Keeping, "of", lambda *_: 1 / 0)
    recorder = run([WholeRun(tmp_path / "run.mcap")], room, map(a_pass, range(3)))
    assert recorder.troubles == ["recording: ZeroDivisionError: division by zero"]


def test_a_file_that_is_there_is_not_written_over(room, tmp_path):
    (tmp_path / "run.mcap").write_text("evidence")
    with pytest.raises(InputError, match="is there already"):
        recorder_of(room, tmp_path / "run.mcap")
    with pytest.raises(InputError, match="cannot be written"):
        Recorder([WholeRun(tmp_path / "run.mcap")]).begin(room)
    with pytest.raises(InputError, match="name a folder that exists"):
        require_new(tmp_path / "no" / "run.mcap")
    assert (tmp_path / "run.mcap").read_text() == "evidence"


def boxed(folder: Path, **more) -> BlackBox:
    """Keeps a second before and half a second after."""
    folder.mkdir(exist_ok=True)
    return BlackBox(folder, 10 * STEP_NS, 5 * STEP_NS, **more)


class Clock:
    """The time by which passes are heard, a step each."""

    def __init__(self, monkeypatch):
        self.now_ns = 0
        monkeypatch.setattr(recorder_file.time, "monotonic_ns", lambda: self.now_ns)


def run_steps(box: BlackBox, room: Room, passes, clock: Clock) -> Recorder:
    recorder = Recorder([box])
    recorder.begin(room)
    for one in passes:
        clock.now_ns += STEP_NS
        recorder.show(one)
        while recorder._queue:
            time.sleep(0.001)
    recorder.end()
    return recorder


def test_a_stop_leaves_what_was_before_and_after_it(room, tmp_path, monkeypatch):
    clock = Clock(monkeypatch)
    box = boxed(tmp_path / "stops", clock_ns=lambda: clock.now_ns)
    levels = [Level.CLEAR] * 30 + [Level.STOP] * 2 + [Level.CLEAR] * 20
    run_steps(box, room, [a_pass(number, level) for number, level in enumerate(levels)], clock)
    (file,) = (tmp_path / "stops").iterdir()
    kept = kept_in(file)
    assert kept[0] == 20 and kept == list(range(20, kept[-1] + 1))
    assert 34 <= kept[-1] <= 37
    with Recording(file) as recording:
        assert recording.note is None


def test_without_a_stop_nothing_is_written(room, tmp_path):
    run([boxed(tmp_path / "stops")], room, map(a_pass, range(5)))
    assert list((tmp_path / "stops").iterdir()) == []


def test_a_second_stop_soon_after_makes_the_file_longer_and_a_later_one_makes_another(
    room, tmp_path, monkeypatch
):
    clock = Clock(monkeypatch)
    box = boxed(tmp_path / "stops", clock_ns=lambda: clock.now_ns)
    stops = (20, 23, 60)
    passes = [a_pass(n, Level.STOP if n in stops else Level.CLEAR) for n in range(80)]
    recorder = run_steps(box, room, passes, clock)
    first, second = sorted(kept_in(file) for file in (tmp_path / "stops").iterdir())
    assert first[0] == 10 and 27 <= first[-1] <= 30
    assert second[0] == 50 and 64 <= second[-1] <= 67
    assert len(recorder.said) == 2


def test_a_run_that_ends_just_after_a_stop_keeps_it(room, tmp_path):
    passes = [*map(a_pass, range(4)), a_pass(4, Level.STOP)]
    run([boxed(tmp_path / "stops")], room, passes)
    (file,) = (tmp_path / "stops").iterdir()
    assert kept_in(file) == list(range(5))


def test_memory_is_bounded_by_what_is_allowed(room, tmp_path, monkeypatch):
    clock = Clock(monkeypatch)
    noise = np.random.default_rng(1)
    box = boxed(tmp_path / "stops", clock_ns=lambda: clock.now_ns, most_bytes=60_000)

    def noisy(number):
        image = noise.random((36, 48), np.float32) + 1
        return a_pass(number, frames=[DepthFrame("cam00", number, image)])

    recorder = run_steps(box, room, [noisy(number) for number in range(50)], clock)
    (trouble,) = recorder.troubles
    assert "0.06 MB of memory hold 0." in trouble and "not 1 (" in trouble
    assert 2 < len(box._kept) < 12
    held = sum(one.own_size for one in box._kept) + sum(
        len(frame.told.data) for frame in {id(f): f for one in box._kept for f in one.frames}.values()
    )
    assert box._size == held <= 60_000


def test_a_folder_without_permission_is_said_and_the_next_stop_is_kept(room, tmp_path, monkeypatch):
    clock = Clock(monkeypatch)
    box = boxed(tmp_path / "stops", clock_ns=lambda: clock.now_ns)
    recorder = Recorder([box])
    recorder.begin(room)
    folder, box.folder = box.folder, tmp_path / "gone"
    for number, stops in enumerate((False, False, True, False)):
        clock.now_ns += STEP_NS
        recorder.show(a_pass(number, Level.STOP if stops else Level.CLEAR))
        while recorder._queue:
            time.sleep(0.001)
    until = time.monotonic() + 20
    while not recorder.troubles and time.monotonic() < until:
        time.sleep(0.01)
    assert "this stop is not kept" in recorder.troubles[0]
    box.folder = folder
    recorder.show(a_pass(4, Level.STOP))
    recorder.end()
    assert recorder.troubles == [] and len(list(folder.iterdir())) == 1


def decision(level: Level, *latched: Fault) -> Decision:
    speed = 0.0 if level is Level.STOP else 1.0
    phase = Phase.LATCHED if latched else Phase.GUARDING
    return Decision(phase, (Allowed("long +", level, speed, Reason.NONE),), latched, latched)


def test_what_stops_is_said_once_and_what_stood_at_the_begin_is_no_news():
    stops = Stops()
    assert stops.hear(a_pass(0, Level.STOP)) == []
    assert stops.hear(a_pass(1, Level.STOP)) == []
    assert stops.hear(a_pass(2)) == []
    assert stops.hear(a_pass(3, Level.STOP)) == ["long +: stop"]
    assert stops.hear(a_pass(4, Level.STOP, fault="KeyError: x")) == ["KeyError"]
    assert stops.hear(a_pass(5, Level.STOP, fault="KeyError: y")) == []


def test_a_stop_whose_figures_change_is_one_stop_with_a_gate_and_without():
    """It was a new stop in each pass, so that the file of a stop never ended, and filled the disk."""
    stops, gated = Stops(), Stops()
    texts = [f"the oldest image is {age} ms old" for age in (466, 222, 334)]
    found, faults = [], []
    for number, text in enumerate(["", *texts]):
        late = [Fault(Reason.STALE, "", text)] if text else []
        one = a_pass(number, Level.STOP)
        found.append(stops.hear(replace(one, result=replace(one.result, late=text or None))))
        faults.append(gated.hear(replace(one, decision=decision(Level.STOP, *late))))
    assert found == [[], texts[:1], [], []]
    assert [len(news) for news in faults] == [0, 1, 0, 0]


def test_with_a_gate_the_machine_and_its_faults_count():
    stops, late = Stops(), Fault(Reason.STALE, "", "too old")
    passes = [
        (decision(Level.CLEAR), []),
        (decision(Level.STOP), ["the machine: stop"]),
        (decision(Level.STOP), []),
        (decision(Level.STOP, late), [late.sentence]),
        (decision(Level.CLEAR), []),
    ]
    for number, (said, due) in enumerate(passes):
        assert stops.hear(replace(a_pass(number, Level.STOP), decision=said)) == due


def test_what_a_person_asked_of_the_gate_is_kept(room, tmp_path):
    asked = replace(decision(Level.STOP), answer="refused: nothing is latched", held_until_ns=7)
    run([WholeRun(tmp_path / "run.mcap")], room, [replace(a_pass(0), decision=asked)])
    with Recording(tmp_path / "run.mcap") as recording:
        gate = recording.at(0).gate
    assert gate is not None and gate["reset_answer"] == "refused: nothing is latched"
    assert gate["held_until_ns"] == 7 and gate["phase"] == "guarding" and not gate["is_reset"]


def test_a_run_whose_source_fails_keeps_the_stop_that_follows(room, tmp_path):
    from elbowroom.evaluate.recording.sample import loop_of

    class Breaks:
        name = "breaks"

        def __iter__(self):
            yield Snapshot((), {"long": 0.0}, now_ns=1)
            raise OSError("unplugged")

        def close(self):
            pass

    loop: Loop = replace(loop_of(room), room=replace(room, source=Breaks()))
    with pytest.raises(OSError, match="unplugged"):
        loop.run([Recorder([WholeRun(tmp_path / "run.mcap")])])
    with Recording(tmp_path / "run.mcap") as recording:
        assert len(recording) == 2
        assert recording.at(1).judged["fault"] == "OSError: unplugged"
