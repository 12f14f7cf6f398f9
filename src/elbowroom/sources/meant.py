"""What a machine means to do, from a file: a path of its own, or the paths that a bag holds."""

from pathlib import Path

from elbowroom.errors import BagError, JointsError
from elbowroom.motion import Trajectory, read_path
from elbowroom.sensing import MeantPath, MeantPaths
from elbowroom.sources.bags.opened import opened
from elbowroom.sources.bags.trajectories import TRAJECTORIES, Planned, planned_of

DATES_S = 1e8
"""Times from here on are dates, seconds since 1970, and not counted from the run's beginning [s]."""
TABLES = (".csv", ".yaml", ".yml", ".json")


def meant_paths(path: Path, topic: str | None = None) -> MeantPaths:
    """The paths of a file.

    A table or a message (`read_path`) is one path, whose times count from the run's first moment unless they are dates.
    A bag may hold many, in messages JointTrajectory and DisplayTrajectory: each counts from when it was received, its
    times from its header's stamp, or where that is 0 from when it was received.

    Args:
        path: of the file, or the folder of a bag.
        topic: of the bag; None: the one topic of these messages.

    Raises:
        JointsError: no such file, or no path in it.
        BagError, PackageError: a bag that cannot be read.
    """
    if path.suffix.lower() in TABLES or not path.exists():
        given = read_path(path)
        return MeantPaths((_of_trajectory(given),), begins=given.begin_s < DATES_S)
    bag = opened(path)
    topics = bag.of_type(*TRAJECTORIES) if topic is None else [topic]
    if len(topics) != 1:
        known = ", ".join(topics) or f"none of {', '.join(TRAJECTORIES)}"
        raise JointsError(f"{path}: holds paths in {known}; give one with FILE:TOPIC")
    type_ = bag.require(topics[0]).type
    if type_ not in TRAJECTORIES:
        raise BagError(f"{path}: {topics[0]} is {type_}, must be {' or '.join(TRAJECTORIES)}")
    found = []
    for stored in bag.messages(topics[0]):
        what = f"{path}: {topics[0]} received at {stored.received_ns} ns"
        planned = planned_of(type_, bag.read(stored), what)
        if planned is not None:
            found.append(_of_message(planned, stored.received_ns, what))
    if not found:
        raise JointsError(f"{path}: {topics[0]} holds no path with points")
    return MeantPaths(tuple(found))


def _of_trajectory(path: Trajectory) -> MeantPath:
    stamps = [round(time_s * 1e9) for time_s in path.times_s.tolist()]
    return MeantPath(path.joint_names, stamps, path.positions, path.velocities)  # type: ignore[arg-type]


def _of_message(planned: Planned, received_ns: int, what: str) -> MeantPath:
    zero_ns = planned.stamp_ns or received_ns
    stamps = [zero_ns + since for since in planned.since_ns]
    try:
        return MeantPath(planned.names, stamps, planned.positions, planned.velocities, received_ns)  # type: ignore[arg-type]
    except JointsError as error:
        raise JointsError(f"{what}: {error}") from None
