"""How far may the machine follow a path, so that it can still come to rest in space seen to be free?

Let q(t) be the path, T_r the reaction time, t_j the braking time of joint j, and t the moment at which a stop is
commanded. Then, with brakes at their worst, the machine rests

    on the path       at q(s), s <= t + T_r + max_j t_j / 2         if all joints brake together, along the path
    beside the path   in q(t + T_r) + product of [-b_j-, b_j+]      if each joint brakes by itself
    b_j+-             = max over s in [t + T_r, t + T_r + t_j / 2] of the speed of joint j either way, times t_j / 2

b_j is v t_j / 2, the braking distance of a single joint (`braking_distance`), as it shrinks with the speed and no
faster: a braking time may hold a reaction time, in which the joint still follows the path. A joint whose brakes are
better stops earlier, by as much as it likes: so all of that box counts, and not a line through it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from elbowroom.errors import InputError
from elbowroom.machine import Machine
from elbowroom.motion.braking import Braking
from elbowroom.motion.check import Scene
from elbowroom.motion.course import Way, way_of
from elbowroom.motion.kernels.mover import Course
from elbowroom.motion.path_way import PathWay
from elbowroom.motion.stops import Stops
from elbowroom.motion.trajectory import Trajectory
from elbowroom.motion.verdict import Cause, Level, Verdict
from elbowroom.reconstruct.free_space import FreeSpace

ONCE_S = 1e-6
"""Stops that are commanded within this time are one that is commanded at once [s]."""


@dataclass(frozen=True, slots=True)
class Blocked:
    """Where and why a path, or a stop from it, is not free.

    Args:
        time_s: of the path, when the machine gets there; of a stop beside the path, when it is commanded [s].
        cause, link, place_in_world, other_link, zone: as of `Verdict`.
    """

    time_s: float
    cause: Cause
    link: str | None
    place_in_world: tuple[float, float, float] | None
    other_link: str | None = None
    zone: str | None = None

    @classmethod
    def of(cls, verdict: Verdict, time_s: float) -> "Blocked":
        """What ends the travel of a verdict.

        Args:
            verdict: whose cause is not NONE.
            time_s: of the path [s].
        """
        return cls(
            time_s,
            verdict.cause,
            verdict.link,
            verdict.place_in_world,
            verdict.other_link,
            verdict.zone,
        )

    def row(self) -> dict[str, Any]:
        """As a row has it."""
        return {
            "time_s": self.time_s,
            "cause": self.cause.name.lower(),
            "link": self.link,
            "place_m": self.place_in_world,
            "other_link": self.other_link,
            "zone": self.zone,
        }


@dataclass(frozen=True, slots=True, eq=False)
class PathVerdict:
    """The answer for a path.

    Args:
        path: what was asked.
        level: what to do now, by the table of motions, in time: a stop is commanded no later than now where the way is
            free for as long as a stop takes and no longer; slow down up to twice that, take care up to five times.
        blocked: the first point of the path that is blocked; None: none is, as far as was looked.
        stop_blocked: the first stop from the path, before that point, which is blocked beside the path; None: none is.
        follow_until_s: the machine may follow the path so long; a stop that is commanded by then ends at rest in free
            space; None: not even one that is commanded at once does [s].
        rests_by_s: when it rests then on the path, at the latest; None: as `follow_until_s` [s].
        looked_until_s: as far as was looked [s].
        escapes: as of `Verdict`.
    """

    path: Trajectory
    level: Level
    blocked: Blocked | None
    stop_blocked: Blocked | None
    follow_until_s: float | None
    rests_by_s: float | None
    looked_until_s: float
    escapes: bool = False

    @property
    def is_free(self) -> bool:
        """Whether the whole path may be followed, with every stop from it, and the one after it."""
        return self.follow_until_s is not None and self.follow_until_s >= self.path.end_s

    @property
    def cause(self) -> Cause:
        """What ends the part that may be followed; NONE: nothing does, as far as was looked."""
        first = self.first
        return Cause.NONE if first is None else first.cause

    @property
    def first(self) -> Blocked | None:
        """What ends the part that may be followed: the stop that is blocked, else the point of the path."""
        return self.stop_blocked or self.blocked

    @property
    def prefix(self) -> Trajectory | None:
        """The part of the path that may be followed; None: none."""
        if self.follow_until_s is None:
            return None
        return self.path.between(self.path.begin_s, self.follow_until_s)

    def row(self) -> dict[str, Any]:
        """As a row of results; times are the path's."""
        return {
            "joints_of_path": list(self.path.joint_names),
            "begin_s": self.path.begin_s,
            "end_s": self.path.end_s,
            "level": self.level.name.lower(),
            "is_free": self.is_free,
            "follow_until_s": self.follow_until_s,
            "rests_by_s": self.rests_by_s,
            "looked_until_s": self.looked_until_s,
            "blocked": None if self.blocked is None else self.blocked.row(),
            "stop_blocked": None if self.stop_blocked is None else self.stop_blocked.row(),
            "escapes": self.escapes,
        }


def check_path(
    space: FreeSpace,
    machine: Machine,
    path: Trajectory,
    joints: Mapping[str, float],
    braking: Braking,
    horizon_s: float | None = None,
) -> PathVerdict:
    """How far a machine may follow a path, so that it can stop at any moment and rest in space seen to be free.

    The machine is swept along the path by the laws of `check_motion`, all of them, and so is what it takes to stop.
    Less evidence never lets it follow a path for longer.

    Args:
        space: the free space, of now; what moves there later is for whoever asks again.
        machine: the machine.
        path: from where it is; what it does after the last point is not known, so it counts as stopping there, from the
            speed that it has then.
        joints: where it is now, by name [m or rad].
        braking: how its joints come to rest.
        horizon_s: how far ahead to look, at least as far as a stop takes [s]; None: the whole path.

    Returns:
        The verdict; neither its times nor the places are beyond the truth in this space.

    Raises:
        MachineError: as `check_motion`.
        JointsError: a path that this machine cannot follow, or that does not begin where it is.
        InputError: a horizon that is not above 0.
    """
    if horizon_s is not None and not horizon_s > 0:
        raise InputError(f"check_path: horizon_s is {horizon_s}, must be above 0 [s]")
    way = PathWay.of(machine, joints, path, braking)
    scene = Scene.of(space, machine, machine.positions(joints))
    return path_in(scene, path, way, braking, horizon_s)


def path_in(
    scene: Scene, path: Trajectory, way: PathWay, braking: Braking, horizon_s: float | None = None
) -> PathVerdict:
    """The answer for a path.

    Args:
        scene: in which the machine stands where the path begins.
        path: what was asked.
        way: of it.
        braking, horizon_s: as of `check_path`.
    """
    looked_s = way.rests_s
    if horizon_s is not None:
        looked_s = min(way.begin_s + max(horizon_s, way.stop_s), looked_s)
    motion = way.asked(scene.machine, looked_s)
    along = scene.verdict(motion, way_of(scene.machine, way.positions[0], motion))
    judged = _judged(path, way, along, looked_s)
    if not braking.leaves_path or judged.follow_until_s is None:
        return judged
    stops = _stops_of(scene.machine, way, braking, judged.follow_until_s)
    return _with_stops(judged, scene.verdict(motion, stops), way)


def _stops_of(machine: Machine, way: PathWay, braking: Braking, until_s: float) -> Way:
    """The stops that are commanded from the beginning on up to a time, of which a stop at once is always one."""
    times = way.times_s - way.begin_s
    knots = np.concatenate([[-1.0], times[1:]])  # where the machine is, is no time of the path's
    length = max(until_s - way.begin_s, ONCE_S)
    return Way(Course(knots, way.positions), length, "s", Stops.of(machine, way, braking))


def _with_stops(judged: PathVerdict, verdict: Verdict, way: PathWay) -> PathVerdict:
    """What the stops beside the path leave of what may be followed."""
    if verdict.cause is Cause.NONE:
        return judged
    blocked = Blocked.of(verdict, way.begin_s + verdict.free_travel)
    if verdict.free_travel <= 0:
        return replace(judged, level=Level.STOP, stop_blocked=blocked, follow_until_s=None, rests_by_s=None)
    return replace(
        judged,
        level=_level(way, blocked.time_s, True),
        stop_blocked=blocked,
        follow_until_s=blocked.time_s,
        rests_by_s=min(blocked.time_s + way.stop_s, judged.rests_by_s or way.rests_s),
    )


def longest_safe_prefix(
    space: FreeSpace,
    machine: Machine,
    path: Trajectory,
    joints: Mapping[str, float],
    braking: Braking,
    horizon_s: float | None = None,
) -> Trajectory | None:
    """The longest part of a path, from its beginning, from all of which a stop ends at rest in space seen to be free.

    So a machine that is told to stop at its end, or before, stays in that space (an execution shield). Asked again
    while it moves, with the space of then, it gives the next part.

    Args:
        space, machine, path, joints, braking, horizon_s: as of `check_path`.

    Returns:
        None: not even a stop at once ends in free space.

    Raises:
        MachineError, JointsError, InputError: as `check_path`.
    """
    return check_path(space, machine, path, joints, braking, horizon_s).prefix


def _judged(path: Trajectory, way: PathWay, verdict: Verdict, looked_s: float) -> PathVerdict:
    """What the sweep along the path comes to."""
    blocked = None
    rests_s = looked_s
    if verdict.cause is not Cause.NONE:
        rests_s = min(looked_s, way.time_at(verdict.free_travel))
        blocked = Blocked.of(verdict, rests_s)
    until_s = min(rests_s - way.stop_s, path.end_s)
    stops = until_s < way.begin_s
    return PathVerdict(
        path,
        _level(way, until_s, stops or blocked is not None),
        blocked,
        None,
        None if stops else until_s,
        None if stops else min(until_s + way.stop_s, rests_s),
        looked_s,
        verdict.escapes,
    )


def _level(way: PathWay, until_s: float, is_blocked: bool) -> Level:
    """By how long the way is free, with the stop that ends it."""
    if not is_blocked:
        return Level.CLEAR
    stop_s = max(way.stop_s, ONCE_S)
    return Level.at(until_s - way.begin_s + stop_s, stop_s)
