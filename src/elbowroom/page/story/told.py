"""A moment in what JSON knows: all that the page says is said of this, be it of a run or of a recording."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from elbowroom.errors import JointsError
from elbowroom.monitor.blackbox.kept_pass import judged, plain
from elbowroom.monitor.blackbox.recording import RecordedPass
from elbowroom.monitor.face import Pass
from elbowroom.monitor.gate.told import decision_row
from elbowroom.monitor.health.health import Health
from elbowroom.monitor.rows import shares_pct
from elbowroom.motion import Trajectory
from elbowroom.sensing import Snapshot

STRIDE = 8
"""Every so many-th pixel of each row and column is looked at for the share of valid ones."""

Told = Mapping[str, Any]
"""A moment: sequence, wall_ns, now_ns, joints, path, stamps, bounds, valid, judged, gate, health, shares."""


def told_of(done: Pass, wall_ns: int) -> dict[str, Any]:
    """A pass that was just made.

    Args:
        done: the pass.
        wall_ns: when, by the computer's calendar [ns].
    """
    result, decision = done.result, done.decision
    shares = None
    if not result.verdicts and result.space is not None:
        shares = plain(shares_pct(result.space))
    return {
        "sequence": result.sequence,
        "wall_ns": wall_ns,
        **_given(done.snapshot),
        "judged": judged(replace(result, space=None)),
        "gate": None if decision is None else plain(decision_row(decision)),
        "health": _health(result.health),
        "shares": shares,
    }


def told_of_recorded(one: RecordedPass) -> dict[str, Any]:
    """A pass of a recording, as it was kept.

    Args:
        one: the pass.
    """
    return {
        "sequence": one.sequence,
        "wall_ns": one.wall_ns,
        **_given(one.snapshot),
        "judged": dict(one.judged),
        "gate": None if one.gate is None else dict(one.gate),
        "health": None,
        "shares": None,
    }


def _given(snapshot: Snapshot) -> dict[str, Any]:
    """What came, images apart."""
    return {
        "now_ns": snapshot.now_ns,
        "joints": None if snapshot.joints is None else plain(dict(snapshot.joints)),
        "path": _path(snapshot),
        "stamps": {frame.camera: frame.stamp_ns for frame in snapshot.frames},
        "bounds": dict(snapshot.clock_bounds_ns),
        "valid": {frame.camera: _valid(frame.depth_m) for frame in snapshot.frames},
        "skew_ms": plain(snapshot.skew_ms),
    }


def _path(snapshot: Snapshot) -> dict[str, Any] | None:
    """The path that was asked for, in straight lines; its time 0 is the moment's, as where it was judged."""
    meant = snapshot.path
    at_ns = snapshot.moment_ns if snapshot.joints_ns is None else snapshot.joints_ns
    if meant is None or at_ns is None:
        return None
    times_s = (meant.stamps_ns - at_ns) / 1e9
    with suppress(JointsError):  # what is no path is said by who judges
        given = Trajectory(meant.joint_names, times_s, meant.positions, meant.velocities).straightened()
        return {
            "joint_names": list(given.joint_names),
            "times_s": given.times_s.tolist(),
            "positions": given.positions.tolist(),
        }
    return None


def _valid(depth_m: Any) -> float:
    """Share of pixels that hold a depth."""
    some = depth_m[::STRIDE, ::STRIDE]
    with np.errstate(invalid="ignore"):
        return float(np.count_nonzero((some > 0) & (some < np.inf)) / max(some.size, 1))


def _health(health: Health | None) -> dict[str, Any] | None:
    if health is None:
        return None
    return {
        camera.camera: {
            "condition": camera.condition.name.lower(),
            "turn_deg": None if camera.shift is None else plain(camera.shift.turn_deg),
            "move_mm": None if camera.shift is None else plain(camera.shift.move_mm),
        }
        for camera in health.cameras
    }
