"""Sick sources in a run of a small simulated room: what a camera alone had freed is blocked in the same pass."""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from elbowroom.files.json_rows import json_rows
from elbowroom.guard.reason import Reason
from elbowroom.monitor.gate.faults import faults_of
from elbowroom.monitor.health.checks import Checks
from elbowroom.monitor.rows import Rows
from elbowroom.monitor.start.looking import looks_of, streams_of
from elbowroom.monitor.start.start import started
from elbowroom.motion import Cause, Level
from elbowroom.sensing import DepthFrame, Snapshot
from elbowroom.site import Site
from elbowroom.sources import open_room
from elbowroom.sources.cameras import with_noise
from reference.small_room import SMALL_ROOM

STEP_S = 0.07
Change = Callable[[int, Snapshot], Snapshot]


class Paced:
    """The simulated room at even times of its own, its snapshots changed on the way."""

    name = "paced"

    def __init__(self, simulated, many: int, change: Change = lambda number, snapshot: snapshot) -> None:
        self.simulated, self.many, self.change = simulated, many, change

    def __iter__(self) -> Iterator[Snapshot]:
        for number, snapshot in enumerate(self.simulated.at(n * STEP_S for n in range(self.many))):
            yield self.change(number, snapshot)

    def close(self) -> None:
        pass


class Kept:
    """A face that keeps all."""

    def __init__(self) -> None:
        self.passes = []

    def begin(self, room) -> None:
        pass

    def show(self, done) -> None:
        self.passes.append(done)

    def end(self) -> None:
        pass


@pytest.fixture(scope="module")
def ready(tmp_path_factory):
    """The small room with noise, commissioned and started once."""
    path = tmp_path_factory.mktemp("room") / "room.yaml"
    path.write_text(SMALL_ROOM)
    return started(open_room(with_noise(Site.load(path), "tof")), lambda told: None)


def run(ready, many: int, change: Change, faces=()):
    """By the time of the room, as this computer may be slow: looks at clocks are another test's."""
    room = ready.room
    streams = streams_of(room, ready.checks.watch.references)
    loop = replace(
        ready,
        room=replace(room, source=Paced(room.source, many, change)),
        checks=Checks(looks=looks_of(room), streams=streams),
    )
    kept = Kept()
    loop.run([kept, *faces])
    return loop, [done.result for done in kept.passes], kept.passes


def without(snapshot: Snapshot, camera: str) -> Snapshot:
    return replace(snapshot, frames=tuple(f for f in snapshot.frames if f.camera != camera))


def words(space):
    return [space.free_words, space.surface_words, space.blocked_words, space.blind_words]


def test_what_a_frozen_camera_alone_had_freed_is_blocked_in_the_same_pass(ready, tmp_path):
    first: dict[str, DepthFrame] = {}

    def freeze(number: int, snapshot: Snapshot) -> Snapshot:
        """From pass 14 to 19 one camera gives what it gave at 13, with new stamps."""
        frames = []
        for frame in snapshot.frames:
            if number == 13:
                first.setdefault(frame.camera, frame)
            if frame.camera == "cam01" and 14 <= number < 20:
                frame = replace(frame, depth_m=first["cam01"].depth_m.copy())
            frames.append(frame)
        return replace(snapshot, frames=tuple(frames))

    rows = []
    loop, results, passes = run(ready, 26, freeze, [Rows(rows.append)])
    sick = [{each.cause.word for each in result.sick if each.source == "cam01"} for result in results]
    assert sick == [set()] * 14 + [{"frozen"}] * 8 + [set()] * 4
    assert all(result.fault is None for result in results)
    for number in (13, 14, 17, 24):
        seen = passes[number].snapshot
        same = loop.cycle.run(without(seen, "cam01") if 14 <= number < 22 else seen)
        for one, other in zip(words(results[number].space), words(same.space), strict=True):
            assert np.array_equal(one, other)
        assert [v.row() for v in results[number].verdicts] == [v.row() for v in same.verdicts]
    # less evidence frees nothing: the same pass with the camera has all that it has without, and more
    whole, left = loop.cycle.run(passes[14].snapshot).space, results[14].space
    assert not (left.free_words & ~whole.free_words).any() and (whole.free_words & ~left.free_words).any()
    assert [(f.reason, f.subject) for f in faults_of(results[14])] == [(Reason.CAMERA_FROZEN, "cam01")]
    told = [row for row in rows if row["kind"] == "sick"]
    assert told[0]["is_there"] and told[0]["cause"] == "frozen" and told[0]["left_out"]
    assert not told[-1]["is_there"]
    cycle = [row for row in rows if row["kind"] == "cycle"][14]
    assert cycle["sick"][0]["source"] == "cam01" and cycle["stopped_by"] is None
    with json_rows(tmp_path / "rows.json") as add:
        for row in rows:
            add(row)


@pytest.mark.parametrize(
    "joints, word, reason",
    [
        (None, "missing", Reason.JOINTS_MISSING),
        ({"larm": 99.0}, "beyond", Reason.JOINTS_BEYOND),
        ({"larm": float("nan")}, "implausible", Reason.JOINTS_IMPLAUSIBLE),
    ],
)
def test_sick_joints_stop_every_motion_with_their_cause_and_no_pass_fails(ready, joints, word, reason):
    def change(number: int, snapshot: Snapshot) -> Snapshot:
        if number < 6:
            return snapshot
        given = None if joints is None else {**(snapshot.joints or {}), **joints}
        return replace(snapshot, joints=given)

    _, results, _ = run(ready, 8, change)
    assert not results[5].sick
    for result in results[6:]:
        assert [(each.source, each.cause.word) for each in result.sick] == [("joints", word)]
        assert {v.level for v in result.verdicts} == {Level.STOP}
        assert {v.cause for v in result.verdicts} == {Cause.INPUT}
        assert result.fault is None and result.stopped_by == result.sick[0].text
        assert faults_of(result)[0].reason is reason


def test_a_room_whose_cameras_never_appear_is_stop_and_says_which_are_awaited(ready):
    _, results, _ = run(ready, 4, lambda number, snapshot: replace(snapshot, frames=()))
    for result in results:
        assert result.level is Level.STOP and result.fault is None
        assert {v.cause for v in result.verdicts} == {Cause.BLIND}
        assert "cam00, cam01, cam02, cam03, cam04" in result.stopped_by
        told = {each.source: each.text for each in result.sick}
        assert set(told) == {f"cam{n:02d}" for n in range(5)}
        assert all("awaited" in text for text in told.values())
        assert not faults_of(result)


def test_an_image_of_another_size_is_left_out_and_fails_no_pass(ready):
    def change(number: int, snapshot: Snapshot) -> Snapshot:
        frames = [
            replace(f, depth_m=f.depth_m[:, ::2].copy()) if f.camera == "cam02" and number > 2 else f
            for f in snapshot.frames
        ]
        return replace(snapshot, frames=tuple(frames))

    _, results, _ = run(ready, 5, change)
    assert [{each.cause.word for each in result.sick} for result in results[3:]] == [{"wrong_size"}] * 2
    assert all(result.fault is None for result in results)
