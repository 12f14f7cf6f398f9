"""Faults thrown at a running monitor: that each kind is there, and that some of each input are found on the program."""

import pytest

from elbowroom.evaluate.faults import faults, outside
from elbowroom.evaluate.faults.kinds import KINDS, kind_named
from elbowroom.evaluate.faults.receiver import Receiver
from elbowroom.guard.reason import Reason

ASKED = (
    "off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent", "decalibrated", "covered", "covered by half",
    "swapped", "wrong scale", "wrong encoding", "truncated", "clock", "missing", "implausible", "hangs", "suspended",
    "starved", "short of memory", "killed", "watchdog",
)  # fmt: skip


def test_every_kind_that_is_asked_for_is_there_and_names_reasons_that_are():
    assert all(any(kind.name.startswith(name) for kind in KINDS) for name in ASKED)
    assert len({(kind.name, kind.input) for kind in KINDS}) == len(KINDS)
    known = {reason.name.lower() for reason in Reason if reason.is_fault}
    for kind in KINDS:
        assert {cause.split()[0] for cause in kind.causes} <= known, kind.name
        assert (kind.make is None) == (kind.name in outside.FROM_OUTSIDE), kind.name


def test_what_passes_silently_or_is_misnamed_is_counted():
    def row(**more):
        return {"case": "off", "input": "camera", "shown": True, "stopped": True, "after_ms": 40.0,
                "latched": ["camera_gaps cam0"], "noticed_by": "streams", "named": True, **more}  # fmt: skip

    rows = [
        row(),
        row(after_ms=90.0),
        row(stopped=False, after_ms=None, named=False, latched=[]),
        row(named=False),
    ]
    rows.append(row(shown=False, stopped=False, after_ms=None, latched=[], named=False))
    one, every = faults.fault_summary(rows)
    assert (one["times"], one["shown"], one["silent"], one["misnamed"], one["worst_ms"]) == (5, 4, 1, 1, 90.0)
    assert {**one, "case": "all", "input": "", "noticed_by": "", "causes": ""} == every
    assert not faults.DUE[0].met(one)


def test_a_receiver_that_is_not_answered_stands():
    receiver = Receiver(1, 2)
    try:
        assert not receiver.last.goes and receiver.stopped_ns is None
    finally:
        receiver.close()


def test_faults_of_a_camera_and_of_joints_are_found_on_the_running_monitor():
    pytest.importorskip("pymodbus")
    kinds = [
        kind_named("stuck image, stamps go on", "camera"),
        kind_named("missing", "joints"),
    ]
    rows = list(faults.fault_rows(1, 3, 400.0, kinds))
    assert [(row["input"], row["shown"], row["stopped"], row["named"]) for row in rows] == [
        (kind.input, True, True, True) for kind in kinds
    ]
    assert [row["noticed_by"] for row in rows] == ["streams", "streams"]
