"""What a machine means to do, judged from where it is: the rest of its path, and what that leaves of its motions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from elbowroom.errors import JointsError
from elbowroom.machine import Machine
from elbowroom.motion.braking import Braking
from elbowroom.motion.motion import JointPath, Motion
from elbowroom.motion.path import PathVerdict, check_path
from elbowroom.motion.path_way import PathWay
from elbowroom.motion.trajectory import Trajectory
from elbowroom.motion.verdict import Level, Verdict
from elbowroom.reconstruct.free_space import FreeSpace

HORIZON_S = 2.0
"""So far ahead a path is judged, and at least as far as a stop takes [s]."""
LAG_S, STEPS = 0.1, 20
"""A controller follows its path by so much late at most, looked for in so many steps [s]."""
MOVES = 1e-6
"""A joint that a path moves by less stays where it is [m or rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """What is left of a path.

    Args:
        path: from where the machine is on it; its time 0 is the moment that is judged.
        made: by joint, which ways it goes: -1, 1 or both.
    """

    path: Trajectory
    made: Mapping[str, frozenset[int]]


def rest_of(meant: Trajectory, joints: Mapping[str, float]) -> Rest | None:
    """The rest of a path from where the machine is, which may be a little behind; None: the path is over.

    Args:
        meant: the path; its time 0 is when the machine is at `joints`.
        joints: where it is, by name [m or rad].

    Raises:
        JointsError: a joint of the path of which no position is known, points that are no path.
    """
    unknown = [name for name in meant.joint_names if name not in joints]
    if unknown:
        raise JointsError(f"path: joint {unknown[0]} has no position; joints are {', '.join(joints)}")
    whole = meant.straightened()
    if whole.end_s < -LAG_S:
        return None
    begin_s = whole.begin_s
    if begin_s < 0:
        looked = np.clip(np.linspace(-LAG_S, 0.0, STEPS + 1), whole.begin_s, whole.end_s)
        now = np.array([joints[name] for name in whole.joint_names])
        there = np.column_stack([np.interp(looked, whole.times_s, column) for column in whole.positions.T])
        # of places alike the earliest: more of the path is looked at from there
        begin_s = float(looked[np.abs(there - now).max(axis=1).argmin()])
    path = whole.between(begin_s, whole.end_s)
    return Rest(
        path, {name: _ways(column) for name, column in zip(path.joint_names, path.positions.T, strict=True)}
    )


def _ways(column: np.ndarray) -> frozenset[int]:
    steps = np.diff(column)
    return frozenset(way for way in (-1, 1) if (way * steps > MOVES).any())


def asked_of(machine: Machine, joints: Mapping[str, float], rest: Rest, braking: Braking) -> JointPath:
    """The rest of a path as far as it is looked at, as a motion.

    Args:
        machine: whose path it is.
        joints: where it is, by name [m or rad].
        rest: of its path.
        braking: how it comes to rest.

    Raises:
        MachineError, JointsError: as `check_path`.
    """
    way = PathWay.of(machine, joints, rest.path, braking)
    return way.asked(machine, min(way.begin_s + max(HORIZON_S, way.stop_s), way.rests_s))


def check_rest(
    space: FreeSpace, machine: Machine, joints: Mapping[str, float], rest: Rest, braking: Braking
) -> PathVerdict:
    """How far the machine may follow the rest of its path, and rest in free space: `check_path` up to the horizon.

    Args:
        space, machine, joints, braking: as of `check_path`.
        rest: of the path.

    Raises:
        MachineError, JointsError: as `check_path`; also where the machine is not on its path.
    """
    return check_path(space, machine, rest.path, joints, braking, HORIZON_S)


def share_of(verdict: PathVerdict) -> float:
    """The greatest share of its speed at which a path may be followed, 0 to 1, as of a motion: the time that is left
    before a stop has to be commanded, in stops; 1 where nothing is in the way.

    Args:
        verdict: of the path.
    """
    if verdict.level is not Level.DECELERATE:
        return 0.0 if verdict.level is Level.STOP else 1.0
    assert verdict.follow_until_s is not None and verdict.rests_by_s is not None  # else it were stop
    stop_s = verdict.rests_by_s - verdict.follow_until_s
    left_s = verdict.follow_until_s - verdict.path.begin_s
    return min(1.0, left_s / stop_s) if stop_s > 0 else 0.0


def with_path(verdicts: Sequence[Verdict], path: PathVerdict, rest: Rest) -> list[Verdict]:
    """The verdicts of motions, no milder than the path that makes some of them: the most cautious wins.

    Args:
        verdicts: of all motions.
        path: of the path.
        rest: which motions it makes.
    """
    return [_held(verdict, path) if _makes(rest, verdict) else verdict for verdict in verdicts]


def _makes(rest: Rest, verdict: Verdict) -> bool:
    motion = verdict.motion
    return not isinstance(motion, Motion) or motion.direction in rest.made.get(motion.joint, ())


def _held(verdict: Verdict, path: PathVerdict) -> Verdict:
    """The verdict of a motion, or what the path says of it."""
    first, braking = path.first, verdict.motion.braking_distance
    times = {Level.STOP: 0.0, Level.DECELERATE: 1.0 + share_of(path), Level.INFORM: 5.0}.get(path.level)
    if first is None or times is None or verdict.free_travel <= times * braking:
        return verdict
    return replace(
        verdict,
        level=path.level,
        free_travel=times * braking,
        link=first.link,
        place_in_world=first.place_in_world,
        cause=first.cause,
        other_link=first.other_link,
        escapes=False,
        zone=first.zone,
        creep=None,
    )
