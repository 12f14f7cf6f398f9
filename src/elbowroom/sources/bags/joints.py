"""Joints of a bag: what one or several publishers said of each, as one record."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import JointsError
from elbowroom.sensing import JointRecord
from elbowroom.sources.bags.bag import Bag
from elbowroom.sources.bags.messages import JOINT_STATE, joint_state_of
from elbowroom.sources.bags.stamps import Stamped, stamped
from elbowroom.sources.times.two_tellers import clock_fall


class Told(NamedTuple):
    """What was said of the joints.

    Args:
        stamps_ns, positions: of each joint, by rising time [ns], [m or rad].
        notes: what was odd.
        velocities: of each joint at the same times [m/s or rad/s]; NaN where nobody said.
        received_ns: of each joint when what is said of these times had come [ns, the recorder's clock].
        arrivals: of each topic whose headers have stamps, when its messages came and these stamps [ns], shape (n, 2),
            by time of receipt.
        fell: that the clock of a topic went back, in words; None: none did.
    """

    stamps_ns: Mapping[str, NDArray[np.int64]]
    positions: Mapping[str, NDArray[np.float64]]
    notes: Sequence[str]
    velocities: Mapping[str, NDArray[np.float64]]
    received_ns: Mapping[str, NDArray[np.int64]]
    arrivals: Mapping[str, NDArray[np.int64]]
    fell: str | None


def told_of(bag: Bag, topics: Sequence[str]) -> Told:
    """What the joint topics of a bag say of each joint. A position that is not finite says nothing.

    Args:
        bag: opened.
        topics: of sensor_msgs/msg/JointState.

    Raises:
        BagError: a topic that is not there, or a malformed message.
        JointsError: a topic of another type, or two positions of a joint at one time.
    """
    said: dict[str, dict[int, float]] = defaultdict(dict)
    speeds: dict[str, dict[int, float]] = defaultdict(dict)
    came: dict[str, dict[int, int]] = defaultdict(dict)
    arrivals: dict[str, NDArray[np.int64]] = {}
    notes: list[str] = []
    fell: str | None = None
    for topic in topics:
        if bag.require(topic).type != JOINT_STATE:
            raise JointsError(f"{bag.path}: {topic} is {bag.topics[topic].type}, must be {JOINT_STATE}")
        times = stamped(bag, topic)
        notes += times.notes
        if times.by_header and times.messages:
            heard = sorted(
                ((message.stored.received_ns, message.stamp_ns) for message in times.messages),
                key=lambda one: one[0],
            )
            arrivals[topic] = np.array(heard, dtype=np.int64)
        fallen = clock_fall(topic, arrivals[topic]) if topic in arrivals else None
        if fallen is not None:
            notes.append(f"{fallen}: where the machine was is doubtful for as long after that")
        fell = fell or fallen
        for message in times.messages:
            _take((said, speeds, came), bag, topic, message, fallen)
    found = {name: sorted(rows.items()) for name, rows in said.items() if rows}
    return Told(
        {name: np.array([at for at, _ in rows], dtype=np.int64) for name, rows in found.items()},
        {name: np.array([value for _, value in rows]) for name, rows in found.items()},
        notes,
        {name: np.array([speeds[name].get(at, np.nan) for at, _ in rows]) for name, rows in found.items()},
        {name: np.array([came[name][at] for at, _ in rows], dtype=np.int64) for name, rows in found.items()},
        arrivals,
        fell,
    )


def _take(
    to: tuple[Mapping[str, dict[int, float]], Mapping[str, dict[int, float]], Mapping[str, dict[int, int]]],
    bag: Bag,
    topic: str,
    message: Stamped,
    fell: str | None,
) -> None:
    """Adds the positions and velocities of a message to those that were said, and when they came."""
    said, speeds, came = to
    what = f"{bag.path}: {topic} at {message.stamp_ns} ns"
    state = joint_state_of(bag.read(message.stored), what)
    for name, value in zip(state.names, state.positions, strict=False):
        if not np.isfinite(value):
            continue
        before = said[name].setdefault(message.stamp_ns, float(value))
        first_ns = came[name].setdefault(message.stamp_ns, message.stored.received_ns)
        came[name][message.stamp_ns] = min(first_ns, message.stored.received_ns)
        if before != value:
            why = (
                "do two publishers name one joint?"
                if fell is None
                else f"{fell}; set it before recording, and record anew, or cut the bag there"
            )
            raise JointsError(f"{what}: joint {name} is at {before:g} and at {value:g}; {why}")
    for name, value in zip(state.names, state.velocities, strict=False):
        if np.isfinite(value):
            speeds[name][message.stamp_ns] = float(value)


def record_of(told: Told, names: Sequence[str], max_gap_ns: int) -> JointRecord:
    """One record of some joints, at every time at which one of them was said and all others are known.

    Between two of its own times a joint is straight; nothing is known where these are farther apart than `max_gap_ns`.

    Args:
        told: of all joints.
        names: of those that are wanted; each was said.
        max_gap_ns: [ns].

    Raises:
        JointsError: at no time are all known.
    """
    times = np.unique(np.concatenate([told.stamps_ns[name] for name in names]))
    known = np.ones(len(times), dtype=np.bool_)
    for name in names:
        known &= _known(told.stamps_ns[name], times, max_gap_ns)
    times = times[known]
    if not len(times):
        spans = "; ".join(
            f"{name} {told.stamps_ns[name][0]} to {told.stamps_ns[name][-1]} ns" for name in names[:6]
        )
        raise JointsError(f"joints: at no time are all of them known: {spans}")
    # from the first time on, so that as floats the differences are exact
    start = int(times[0])
    positions = {
        name: np.interp(times - start, told.stamps_ns[name] - start, told.positions[name]) for name in names
    }
    speeds = {
        name: np.interp(times - start, told.stamps_ns[name] - start, told.velocities[name])
        for name in names
        if np.isfinite(told.velocities[name]).all()
    }
    # between two of its times a joint is known once the later one has come
    received = [told.received_ns[name][np.searchsorted(told.stamps_ns[name], times)] for name in names]
    return JointRecord(times, positions, max_gap_ns, speeds, np.max(received, axis=0))


def _known(own: NDArray[np.int64], asked: NDArray[np.int64], max_gap_ns: int) -> NDArray[np.bool_]:
    after = np.minimum(np.searchsorted(own, asked), len(own) - 1)
    before = np.maximum(after - 1, 0)
    inside = (asked >= own[0]) & (asked <= own[-1])
    return inside & ((own[after] == asked) | (own[after] - own[before] <= max_gap_ns))
