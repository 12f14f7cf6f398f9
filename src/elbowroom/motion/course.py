"""A motion as straight lines in joint space, cut at the reach and at the limits of a joint."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import MachineError
from elbowroom.machine import Machine
from elbowroom.motion.kernels.mover import Course
from elbowroom.motion.motion import JointPath, Motion
from elbowroom.motion.stops import Stops

ROUNDING = 1e-6
"""A waypoint beyond a limit by this much is rounding, not a fault [m or rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """Where a motion leads.

    Args:
        course: joint positions at knots of rising travel; columns are `machine.joint_names`.
        length: travel that is looked at, 0 where the joint stands at its limit [unit].
        unit: "m", "rad", or "m or rad"; "s" where travel is a time.
        stops: where the machine may come to rest beside the course, after a stop that is commanded on it; then that is
            looked at, and not the course. None: it stays on it.
    """

    course: Course
    length: float
    unit: str
    stops: Stops | None = None

    @property
    def rates(self) -> NDArray[np.float64]:
        """The greatest speed of each joint per unit of travel, shape (n_joints,)."""
        steps = np.abs(np.diff(self.course.positions, axis=0))
        return (steps / np.diff(self.course.travel)[:, None]).max(axis=0)


def way_of(machine: Machine, start: NDArray[np.float64], motion: Motion | JointPath) -> Way:
    """Where a motion leads.

    Args:
        machine: the machine.
        start: its joint positions now, of `machine.positions`, shape (n_joints,).
        motion: what is asked.

    Raises:
        MachineError: the motion names an unknown joint, or a waypoint is out of a joint's limits.
    """
    if isinstance(motion, Motion):
        return _of_joint(machine, start, motion)
    return _of_path(machine, start, motion)


def _of_joint(machine: Machine, start: NDArray[np.float64], motion: Motion) -> Way:
    joint = machine.joint(motion.joint)
    column = machine.joint_names.index(motion.joint)
    room = joint.upper - start[column] if motion.direction > 0 else start[column] - joint.lower
    length = float(max(0.0, min(motion.looked_at, room)))
    knots = np.stack([start, start])
    knots[1, column] += motion.direction * motion.looked_at
    return Way(Course(np.array([0.0, motion.looked_at]), knots), length, joint.unit)


def _of_path(machine: Machine, start: NDArray[np.float64], path: JointPath) -> Way:
    rows = np.concatenate([start[None], _knots(machine, start, path)])
    kept, travel = [0], [0.0]
    for row, step in enumerate(np.abs(np.diff(rows, axis=0)).max(axis=1, initial=0.0).tolist(), start=1):
        if kept[-1] != row - 1:
            step = float(np.abs(rows[row] - rows[kept[-1]]).max(initial=0.0))
        if travel[-1] + step > travel[-1]:  # a step that is lost in rounding goes with the next one
            kept.append(row)
            travel.append(travel[-1] + step)
    knots = rows[kept]
    units = {machine.joint(name).unit for point in path.waypoints for name in point}
    unit = units.pop() if len(units) == 1 else "m or rad"
    length = travel[-1] if path.reach is None else min(path.reach, travel[-1])
    if len(knots) == 1:
        knots, travel = np.stack([start, start]), [0.0, 1.0]
    return Way(Course(np.array(travel), knots), length, unit)


def _knots(machine: Machine, start: NDArray[np.float64], path: JointPath) -> NDArray[np.float64]:
    """Positions of all joints at the waypoints of a path, shape (waypoints, joints)."""
    first = dict(zip(machine.joint_names, start.tolist(), strict=True))
    here, passed = first, []
    for waypoint in path.waypoints:
        here = {**here, **waypoint}
        passed.append(here)
    if not _are_inside(machine, first, passed):
        for before, waypoint in zip([first, *passed], path.waypoints, strict=False):
            _require_inside(machine, waypoint, before)  # the first one that cannot be is named
    try:
        return machine.positions({name: np.array([one[name] for one in passed]) for name in here})
    except MachineError:
        for one in passed:  # the first one that cannot be is named
            machine.positions(one)
        raise


def _are_inside(machine: Machine, first: Mapping[str, float], passed: list[dict[str, float]]) -> bool:
    """Whether all that are passed are as `_require_inside` wants it, many at once."""
    if passed and len(passed[-1]) != len(machine.joint_names):
        return False
    rows = np.array([[one[name] for name in machine.joint_names] for one in [first, *passed]])
    joints = [machine.joint(name) for name in machine.joint_names]
    lower = np.minimum([joint.lower for joint in joints], rows[:-1]) - ROUNDING
    upper = np.maximum([joint.upper for joint in joints], rows[:-1]) + ROUNDING
    return bool(((lower <= rows[1:]) & (rows[1:] <= upper)).all())


def _require_inside(machine: Machine, waypoint: Mapping[str, float], here: Mapping[str, float]) -> None:
    """Refuses a waypoint that leads farther beyond a limit than its joint is now, if it is."""
    for name, value in waypoint.items():
        joint = machine.joint(name)
        lower, upper = min(joint.lower, here[name]), max(joint.upper, here[name])
        if not lower - ROUNDING <= value <= upper + ROUNDING:
            raise MachineError(
                f"joint {name}: {value:g} {joint.unit} is out of its limits, "
                f"{joint.lower:g} to {joint.upper:g} {joint.unit}"
            )
