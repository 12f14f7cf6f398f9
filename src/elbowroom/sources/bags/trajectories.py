"""Paths in messages of ROS 2: trajectory_msgs/JointTrajectory, and what MoveIt shows of its plans."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import BagError
from elbowroom.sources.bags.cdr import Cdr

JOINT_TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
DISPLAY_TRAJECTORY = "moveit_msgs/msg/DisplayTrajectory"
TRAJECTORIES = (JOINT_TRAJECTORY, DISPLAY_TRAJECTORY)
LEAST_POINT = 4 * 4 + 8
"""Bytes that a point has at least."""


class Planned(NamedTuple):
    """A path as a message says it.

    Fields:
        stamp_ns: of its header [ns]; 0: none.
        names: of its joints.
        since_ns: from the header's time to each point [ns].
        positions: shape (n, joints) [m or rad].
        velocities: likewise [m/s or rad/s]; None: none are said.
    """

    stamp_ns: int
    names: Sequence[str]
    since_ns: Sequence[int]
    positions: NDArray[np.float64]
    velocities: NDArray[np.float64] | None


def planned_of(type_: str, data: bytes | memoryview, what: str) -> Planned | None:
    """The path of a message, of several the first; None: it holds no point.

    Args:
        type_: one of `TRAJECTORIES`.
        data: the message.
        what: names it in errors.

    Raises:
        BagError: the message is malformed.
    """
    cdr = Cdr(data, what)
    if type_ == DISPLAY_TRAJECTORY:
        cdr.text()  # of which model
        if cdr.count(4) == 0:
            return None
    stamp_ns = cdr.whole("i") * 1_000_000_000 + cdr.whole("I")
    cdr.text()  # of which frame
    names = cdr.texts()
    points = [_point(cdr, len(names), what) for _ in range(cdr.count(LEAST_POINT))]
    if not points:
        return None
    speeds = [velocities for _, _, velocities in points]
    has_speeds = all(len(each) for each in speeds)
    if not has_speeds and any(len(each) for each in speeds):
        raise BagError(f"{what}: some points have velocities, and others none")
    return Planned(
        stamp_ns,
        names,
        [since for since, _, _ in points],
        np.array([positions for _, positions, _ in points]).reshape(len(points), len(names)),
        np.array(speeds) if has_speeds and names else None,
    )


def _point(cdr: Cdr, joints: int, what: str) -> tuple[int, NDArray[np.float64], NDArray[np.float64]]:
    """Time from the start [ns], positions, velocities."""
    positions, velocities = cdr.reals(), cdr.reals()
    cdr.reals(), cdr.reals()  # accelerations and efforts
    since_ns = cdr.whole("i") * 1_000_000_000 + cdr.whole("I")
    if len(positions) != joints or len(velocities) not in (0, joints):
        raise BagError(
            f"{what}: a point of {len(positions)} positions and {len(velocities)} velocities, of {joints} joints"
        )
    return since_ns, positions, velocities
