"""A pass with a path that the machine means to take: judged, told, kept; off the path everything stops."""

import json

import numpy as np
import pytest

from elbowroom.guard.reason import Reason
from elbowroom.monitor import Cycle, cycle
from elbowroom.monitor.blackbox.kept_pass import Moment as Kept
from elbowroom.monitor.blackbox.kept_pass import judged, pass_record
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.claim import claims_of
from elbowroom.monitor.rows import cycle_rows
from elbowroom.motion import Braking, Cause, Level, Motion
from elbowroom.reconstruct.free_space import FreeSpace
from elbowroom.sensing import MeantPath, MeantPaths, Snapshot
from reference import motion_machines as machines
from reference.motion_machines import HOME, nothing_in, room, touched_by_box

GRID = room(0.05)
NAMES = ("slide", "turn", "nod")
FULL = Braking(dict.fromkeys(NAMES, 1.0), {"slide": 0.4, "turn": 0.6, "nod": 0.2})
MOTIONS = tuple(Motion(name, way, 0.02) for name in NAMES for way in (1, -1))
WALL = touched_by_box(GRID, (0.951, -1.0, 0.4), (1.2, 1.0, 0.8))
T0_NS = 7_000_000_000
PATH = MeantPath(("slide",), [T0_NS, T0_NS + 2_400_000_000], [[0.0], [0.48]])


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return machines.slider_and_arm(tmp_path_factory.mktemp("arm"))


@pytest.fixture
def passes(monkeypatch, arm):
    """What a pass comes to in a room with a wall, of a machine somewhere at some time."""
    monkeypatch.setattr(
        cycle,
        "free_space_of",
        lambda grid, cameras, snapshot, *_, **__: FreeSpace.from_occupied(
            GRID, nothing_in(GRID) | WALL
        ).without(arm, snapshot.joints),
    )
    judging = Cycle(GRID, (), arm, MOTIONS, focused=True, braking=FULL)

    def judge(slide: float, gone_s: float, path: MeantPath | None = PATH):
        now_ns = T0_NS + round(gone_s * 1e9)
        return judging.run(Snapshot((), {**HOME, "slide": slide}, now_ns=now_ns, path=path))

    return judge


def test_the_first_blocked_point_is_told_with_time_and_place_and_only_its_motion_is_held(passes) -> None:
    free, bound = passes(0.0, 0.0, None), passes(0.23, 1.15)
    assert free.path is None and free.off_path is None and bound.fault is None
    assert bound.path is not None and bound.path.level is Level.STOP
    row = next(row for row in cycle_rows(bound, 0.0) if row["kind"] == "cycle")
    first = row["path"]["blocked"] or row["path"]["stop_blocked"]
    assert first["cause"] == "surface" and first["place_m"] and row["path"]["follow_until_s"] is None
    stops = {(v.motion.joint, v.motion.direction) for v in bound.verdicts if v.level is Level.STOP}
    without = passes(0.23, 1.15, None)
    before = {(v.motion.joint, v.motion.direction) for v in without.verdicts if v.level is Level.STOP}
    assert stops - before == {("slide", 1)}
    json.dumps(row["path"])


def test_a_machine_that_is_not_on_its_path_stops_for_that_cause(passes) -> None:
    off = passes(0.0, 1.0)
    assert off.off_path is not None and "slide" in off.off_path and off.path is None
    assert {v.cause for v in off.verdicts} == {Cause.OFF_PATH} and {v.level for v in off.verdicts} == {
        Level.STOP
    }
    assert {claim.reason for claim in claims_of(off.verdicts, 0.1)} == {Reason.OFF_PATH}
    assert not Reason.OFF_PATH.is_fault
    strange = MeantPath(("elbow",), [T0_NS], [[0.0]])
    assert "elbow" in (passes(0.0, 0.0, strange).off_path or "")


def test_a_path_that_is_over_says_nothing(passes) -> None:
    assert passes(0.0, 9.0).off_path is None and passes(0.0, 9.0).path is None


def test_what_is_kept_of_a_path_gives_the_same_one(passes) -> None:
    result = passes(0.1, 0.5)
    snapshot = Snapshot((), {**HOME, "slide": 0.1}, now_ns=T0_NS, path=PATH)
    record = json.loads(json.dumps(pass_record(Kept(Pass(snapshot, result, 0.0), 0, 0, 0), [])))
    again = MeantPath(**record["given"]["path"])
    assert again.stamps_ns.tolist() == PATH.stamps_ns.tolist()
    assert again.positions.tobytes() == PATH.positions.tobytes() and again.said_ns is None
    assert record["judged"]["path"] == json.loads(json.dumps(judged(passes(0.1, 0.5))["path"]))


def test_of_several_paths_the_last_one_that_was_said_counts_until_it_is_over() -> None:
    second = MeantPath(("turn",), [10**10, 2 * 10**10], [[0.0], [1.0]], said_ns=5 * 10**9)
    paths = MeantPaths((PATH, second))
    assert paths.at(4 * 10**9, 0).joint_names == ("slide",)
    assert paths.at(6 * 10**9, 0).joint_names == ("turn",)
    assert paths.at(3 * 10**10, 0) is None
    begins = MeantPaths((MeantPath(("turn",), [0, 10**9], [[0.0], [1.0]]),), begins=True)
    assert begins.at(5 * 10**9, 5 * 10**9).stamps_ns.tolist() == [5 * 10**9, 6 * 10**9]


def test_of_a_long_path_what_is_about_now_is_handed_on() -> None:
    stamps = np.arange(1000) * 100_000_000
    long = MeantPath(("turn",), stamps, np.linspace(0, 1, 1000)[:, None], np.zeros((1000, 1)))
    part = long.about(50_000_000_000)
    assert (
        part.stamps_ns[0] <= 49_800_000_000
        and part.stamps_ns[-1] >= 55_000_000_000
        and len(part.stamps_ns) < 60
    )
    assert part.velocities is not None and len(part.velocities) == len(part.stamps_ns)
    assert long.about(-5).stamps_ns[0] == 0 and long.about(10**12).stamps_ns.tolist() == [stamps[-1]]
