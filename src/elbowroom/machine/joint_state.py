"""Positions of a machine's joints as somebody says them: possible or not."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from elbowroom.errors import MachineError
from elbowroom.machine.joint import Joint, Unit
from elbowroom.machine.kernels.body import Tree

ROUNDING = 1e-6
"""Positions beyond a limit by this much are rounding, not a fault [m or rad]."""

Joints = Mapping[str, ArrayLike]
"""Joint positions by name [m or rad]: numbers, or arrays of one length n for n configurations."""


class WrittenPosition(float):
    """A joint's position that somebody wrote with a unit: a number that the other kind of joint refuses.

    Args:
        value: the position [m or rad].
        unit: "m" or "rad", whichever it is then in.
        written: as it was written, such as "900mm".
    """

    def __new__(cls, value: float, unit: Unit, written: str) -> Self:
        """As the class says."""
        made = super().__new__(cls, value)
        made.unit, made.written = unit, written
        return made

    unit: Unit
    written: str

    def __getnewargs__(self) -> tuple[float, Unit, str]:  # type: ignore[override]
        """What a copy is made of."""
        return float(self), self.unit, self.written


class JointTolerance(NamedTuple):
    """How far a joint may be said to be where it cannot be: encoders and descriptions differ by little.

    Args:
        rad: for joints that turn [rad].
        m: for joints that slide [m].
        own: of joints that have another one: name and tolerance [rad or m].
    """

    rad: float = float(np.radians(1.0))
    m: float = 0.005
    own: tuple[tuple[str, float], ...] = ()

    def of(self, joint: Joint) -> float:
        """Of a joint [rad or m]; never less than rounding."""
        shared = self.m if joint.unit == "m" else self.rad
        return max(dict(self.own).get(joint.name, shared) if self.own else shared, ROUNDING)


class Follower(NamedTuple):
    """A joint that follows another one: position = multiplier * position of `leader` + offset.

    Args:
        joint: that follows.
        leader: name of the commanded joint at the end of its chain.
        multiplier: without unit, or [m/rad], [rad/m] where the kinds differ.
        offset: [m or rad].
    """

    joint: Joint
    leader: str
    multiplier: float
    offset: float


def followers_of(
    joints: Sequence[Joint], link_names: Sequence[str], joint_names: Sequence[str], tree: Tree
) -> tuple[Follower, ...]:
    """Each joint that follows another one, and where that puts it.

    Args:
        joints: of a machine.
        link_names: in the order of the tree.
        joint_names: of the commanded joints, in the order of its columns.
        tree: of the machine.
    """
    rows = [(joint, link_names.index(joint.child)) for joint in joints if joint.mimic is not None]
    return tuple(
        Follower(joint, joint_names[tree.column[row]], float(tree.multiplier[row]), float(tree.offset[row]))
        for joint, row in rows
    )


def possible_positions(
    machine: str, commanded: Sequence[Joint], tolerance: JointTolerance, joints: Joints
) -> dict[str, NDArray[np.float64]]:
    """The positions of all commanded joints, after finding them possible; others are left out.

    Args:
        machine: name of the machine, for errors.
        commanded: its joints.
        tolerance: by how much a position may lie beyond a limit.
        joints: positions by name, numbers or arrays [m or rad].

    Raises:
        MachineError: a joint without a position, a value that is not finite or out of the joint's limits.
    """
    found = {}
    for joint in commanded:
        if joint.name not in joints:
            raise MachineError(
                f"machine {machine}: joint {joint.name!r} has no position; all joints need one"
            )
        values = _finite(joint, joints[joint.name])
        over = tolerance.of(joint)
        beyond = (values < joint.lower - over) | (values > joint.upper + over)
        if beyond.any():
            raise MachineError(
                f"joint {joint.name}: {values[beyond].flat[0]:g} {joint.unit} is out of its limits, "
                f"{joint.lower:g} to {joint.upper:g} {joint.unit}"
            )
        found[joint.name] = values
    return found


def require_followers(
    machine: str,
    followers: Sequence[Follower],
    tolerance: JointTolerance,
    joints: Joints,
    found: Mapping[str, NDArray[np.float64]],
) -> None:
    """Refuses followers that are said to be elsewhere than the joints that they follow put them.

    Args:
        machine: name of the machine, for errors.
        followers: of the machine.
        tolerance: by how much a follower may be elsewhere.
        joints: positions by name, numbers or arrays [m or rad]; of followers that are not there nothing is asked.
        found: of the commanded joints, as of `possible_positions`.

    Raises:
        MachineError: one is elsewhere, or arrays of unlike lengths.
    """
    for joint, leader, multiplier, offset in followers:
        if joint.name not in joints:
            continue
        values, expected = _finite(joint, joints[joint.name]), multiplier * found[leader] + offset
        if values.ndim and np.ndim(expected) and values.shape != np.shape(expected):
            raise MachineError(
                f"machine {machine}: joint arrays of unlike lengths: {leader} {np.size(expected)}, "
                f"{joint.name} {values.size}"
            )
        values, expected = np.broadcast_arrays(values, expected)
        off = np.abs(values - expected) > tolerance.of(joint)
        if off.any():
            raise MachineError(
                f"joint {joint.name}: {values[off].flat[0]:g} {joint.unit}, but it follows {leader}, which "
                f"puts it at {expected[off].flat[0]:g} {joint.unit}; the machine is not as its description says"
            )


def _finite(joint: Joint, given: ArrayLike) -> NDArray[np.float64]:
    """A joint's positions as numbers [m or rad]."""
    if isinstance(given, WrittenPosition) and given.unit != joint.unit:
        does, units = ("slides", "m or mm") if joint.unit == "m" else ("turns", "rad or deg")
        raise MachineError(
            f"joint {joint.name}: {given.written} cannot be its position: it {does}; write {units}"
        )
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise MachineError(f"joint {joint.name}: {given!r} is not a number [{joint.unit}]") from None
    if not np.isfinite(values).all():
        raise MachineError(f"joint {joint.name}: position is not finite, got {given!r} [{joint.unit}]")
    return values
