"""A trajectory as the sweep takes it: from where the machine is, along the path, and on until it rests."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import JointsError
from elbowroom.machine import Machine
from elbowroom.motion.braking import Braking
from elbowroom.motion.motion import JointPath
from elbowroom.motion.trajectory import Trajectory

FASTER = 1e-3
"""A path may be faster than full speed by this share: rounding."""
ROUNDING = 1e-6
"""A path may go beyond a limit by this much [m or rad]."""
LEAST_TRAVEL = 1e-9
"""A stop that takes less travel than this takes this much: braking distances are above 0 [m or rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class PathWay:
    """A path over time, from where the machine is until it rests after the path's end.

    Args:
        times_s: of its knots, rising; the first two are one time, where the machine is not quite where the path begins
            [s].
        positions: of all joints of the machine there, between them straight, shape (n, joints) [m or rad].
        travel: at each knot, as of `JointPath`.
        stop_s: path time that a stop takes at most, reaction and braking [s].
        end_s: of the path; what is later is the stop after it [s].
    """

    times_s: NDArray[np.float64]
    positions: NDArray[np.float64]
    travel: NDArray[np.float64]
    stop_s: float
    end_s: float

    @classmethod
    def of(cls, machine: Machine, joints: Mapping[str, float], path: Trajectory, braking: Braking) -> Self:
        """A path of a machine, after finding it possible.

        Args:
            machine: the machine.
            joints: where it is now, by name [m or rad].
            path: from there on; joints that it does not name stay.
            braking: how its joints come to rest.

        Raises:
            MachineError: an unknown joint, a joint position that is missing or impossible, or beyond a limit.
            JointsError: a joint of the path without a speed, one that is faster than its full speed, a path that does
                not begin where the machine is.
        """
        machine.require_joints(path.joint_names)
        straight, start = path.straightened(), machine.positions(joints)
        rows = np.tile(start, (len(straight.times_s), 1))
        for name, column in zip(straight.joint_names, straight.positions.T, strict=True):
            if name in machine.joint_names:
                rows[:, machine.joint_names.index(name)] = column
        moving = [name for name in path.joint_names if name in machine.joint_names]
        _require_inside(machine, straight.times_s, rows, start)
        _require_speeds(moving, straight, path.end_velocities, braking)
        moving = [name for name in moving if name in braking.speeds]
        _require_begin(machine, rows[0], start)
        slowest_s = max((braking.times_s[name] for name in moving), default=0.0)
        stop_s = braking.reaction_time_s + slowest_s / 2
        times, knots = [straight.times_s[:1], straight.times_s], [start[None], rows]
        after_s: NDArray[np.float64] = np.array([path.end_s + stop_s])
        last = _coasting(machine, rows[-1], path, stop_s)
        if last is not None:
            times, knots = [*times, after_s], [*knots, last[None]]
        positions = np.concatenate(knots)
        steps = np.abs(np.diff(positions, axis=0)).max(axis=1, initial=0.0)
        return cls(
            np.concatenate(times), positions, np.concatenate([[0.0], np.cumsum(steps)]), stop_s, path.end_s
        )

    @property
    def begin_s(self) -> float:
        """When it begins [s]."""
        return float(self.times_s[0])

    @property
    def rests_s(self) -> float:
        """When the machine rests after the whole path, at the latest [s]."""
        return self.end_s + self.stop_s

    def travel_at(self, time_s: float) -> float:
        """How far the machine has come at a time, of the times at a jump the later one.

        Args:
            time_s: of the path [s].
        """
        return float(np.interp(time_s, self.times_s[1:], self.travel[1:]))

    def time_at(self, travel: float) -> float:
        """When the machine has come so far, at the earliest [s].

        Args:
            travel: as of `JointPath`.
        """
        after = int(np.searchsorted(self.travel, travel, side="left"))
        if after == 0 or after == len(self.travel):
            return float(self.times_s[min(after, len(self.travel) - 1)])
        share = (travel - self.travel[after - 1]) / (self.travel[after] - self.travel[after - 1])
        step = self.times_s[after] - self.times_s[after - 1]
        return float(self.times_s[after - 1] + share * step)

    def asked(self, machine: Machine, until_s: float) -> JointPath:
        """The same as a motion whose braking distance is what a stop that is commanded at once takes.

        Args:
            machine: whose joints these are.
            until_s: it is looked at so far [s].
        """
        points = [dict(zip(machine.joint_names, row.tolist(), strict=True)) for row in self.positions]
        stop = max(self.travel_at(self.begin_s + self.stop_s), LEAST_TRAVEL)
        return JointPath(points, stop, max(self.travel_at(until_s), LEAST_TRAVEL))


def _coasting(
    machine: Machine, row: NDArray[np.float64], path: Trajectory, stop_s: float
) -> NDArray[np.float64] | None:
    """Where the machine may be after a stop that begins at the path's end; None: it stands there."""
    beyond = row.copy()
    for name, speed in zip(path.joint_names, path.end_velocities.tolist(), strict=True):
        if name in machine.joint_names and speed:
            joint, column = machine.joint(name), machine.joint_names.index(name)
            lower, upper = min(joint.lower, row[column]), max(joint.upper, row[column])
            beyond[column] = min(max(row[column] + speed * stop_s, lower), upper)
    return None if stop_s == 0 or (beyond == row).all() else beyond


def _require_inside(
    machine: Machine, times: NDArray[np.float64], rows: NDArray[np.float64], start: NDArray[np.float64]
) -> None:
    """Refuses a path beyond a joint's limits, farther than the machine is now."""
    for column, name in enumerate(machine.joint_names):
        joint = machine.joint(name)
        low, high = min(joint.lower, start[column]) - ROUNDING, max(joint.upper, start[column]) + ROUNDING
        out = np.flatnonzero((rows[:, column] < low) | (rows[:, column] > high))
        if not len(out):
            continue
        value = rows[out[0], column]
        text = f"path: at {times[out[0]]:g} s joint {name} is at {value:g} {joint.unit}, out of its limits"
        degrees = np.degrees([joint.lower, joint.upper])
        hint = ""
        if (
            joint.unit == "rad"
            and degrees[0] <= rows[:, column].min()
            and rows[:, column].max() <= degrees[1]
        ):
            hint = "; if these are degrees, write radians"
        raise JointsError(f"{text}, {joint.lower:g} to {joint.upper:g} {joint.unit}{hint}")


def _require_speeds(
    moving: list[str], path: Trajectory, at_end: NDArray[np.float64], braking: Braking
) -> None:
    """Refuses a joint that moves and has no speed, or is faster than that."""
    steps = np.diff(path.times_s)
    for name, column, last in zip(path.joint_names, path.positions.T, at_end.tolist(), strict=True):
        speeds = np.append(np.abs(np.diff(column)) / steps, abs(last))
        if name not in moving or not speeds.any():
            continue
        if name not in braking.speeds:
            known = ", ".join(braking.speeds) or "none"
            raise JointsError(
                f"path: joint {name} has no speed and no braking time; joints that have: {known}"
            )
        fast = np.flatnonzero(speeds > braking.speeds[name] * (1 + FASTER))
        if len(fast) and len(path.times_s) > 1:
            raise JointsError(
                f"path: at {path.times_s[fast[0]]:g} s joint {name} moves at {speeds[fast[0]]:g} a second, its full "
                f"speed is {braking.speeds[name]:g} [m/s or rad/s]: slow the path down, or correct the speed"
            )


def _require_begin(machine: Machine, first: NDArray[np.float64], start: NDArray[np.float64]) -> None:
    """Refuses a path that begins elsewhere than where the machine is."""
    for name, said, here in zip(machine.joint_names, first, start, strict=True):
        joint = machine.joint(name)
        if abs(said - here) > machine.tolerance.of(joint):
            raise JointsError(
                f"path: it begins with joint {name} at {said:g} {joint.unit}, and the machine is at {here:g} "
                f"{joint.unit}: it is the path of another moment, or the machine is elsewhere"
            )
