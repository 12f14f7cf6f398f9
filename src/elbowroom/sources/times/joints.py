"""Whether a record of joints is one of this machine, in its units, and of the images' time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import JointsError
from elbowroom.finding import Finding
from elbowroom.machine import Joint, Machine
from elbowroom.sensing import JointRecord
from elbowroom.sensing.joints import END_SLACK_NS
from elbowroom.site.recording_entry import BagRecording, StampedFolder
from elbowroom.site.site import Site
from elbowroom.sources.times.cause import Span, cause_text
from elbowroom.sources.times.joint_names import meant
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.series import length_text, span_text, usual_step_ns
from elbowroom.sources.times.stamp import NS, WORDS
from elbowroom.sources.times.two_tellers import SHARE, steps_of, to_and_fro

FASTEST_ROWS_HZ = 20_000
"""No machine tells its joints more often."""
SCARCE = 0.1
"""Where joints are known at less than this share of the images, another unit is tried."""
MOST_TURNS = 2
"""An encoder that counts on is off by no more whole turns; degrees are."""
TOO_FAST, SLOW_ENOUGH = 10.0, 1.5
"""Speeds above so many times full speed are none; those below so many times may be."""


def of_machine(
    site: Site, machine: Machine, path: Path, record: JointRecord, fell: str | None = None
) -> JointRecord:
    """The columns of a record that are joints of the machine, in metres and radians.

    Args:
        site: of the recording.
        machine: the site's.
        path: of the record, to be named.
        record: as the file has it.
        fell: that its clock went back, in words; None: it did not.

    Raises:
        JointsError: a joint without a column, one that two publishers name, or turning joints that are in degrees where
            radians are said.
    """
    recording = site.entry.recording
    assert isinstance(recording, StampedFolder | BagRecording)
    for name in machine.joint_names:
        if name not in record.joints:
            told = ", ".join(record.joints)
            raise JointsError(
                f"{path}: no column for joint {name}{meant(name, record.joints)}; columns are {told}"
            )
    turning = [name for name in machine.joint_names if machine.joint(name).unit == "rad"]
    if recording.angle_unit == "rad":
        _require_one_teller(site, path, [machine.joint(name) for name in machine.joint_names], record, fell)
        _require_radians(site, path, [machine.joint(name) for name in turning], record)
    in_radians = np.radians if recording.angle_unit == "deg" else np.asarray

    def own(told: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
        names = [name for name in machine.joint_names if name in told]
        return {name: in_radians(told[name]) if name in turning else told[name] for name in names}

    return replace(record, positions=own(record.positions), velocities=own(record.velocities))


def _require_one_teller(
    site: Site, path: Path, joints: Sequence[Joint], record: JointRecord, fell: str | None
) -> None:
    """Refuses joints that are in two places by turns, as of two publishers, or of a clock that went back."""
    recording = site.entry.recording
    if not isinstance(recording, BagRecording):
        return  # a file of rows has one writer
    topics = ", ".join(recording.joint_topics)
    for joint in joints:
        given, entry = record.positions[joint.name], site.entry.joints.get(joint.name)
        if entry is None or len(given) < 3:
            continue
        limit = TOO_FAST * entry.speed_of(joint)
        moved = steps_of(joint, given)
        if fell is not None and _fastest(record.stamps_ns, moved) > limit:
            raise JointsError(
                f"{path}: {fell}: joint {joint.name} is in two places at once after that; set the clock before "
                "recording (chrony steps it at its start), and record anew, or cut the bag there"
            )
        steps = to_and_fro(record.stamps_ns, moved, limit)
        if len(steps) > SHARE * len(given):
            raise JointsError(
                f"{path}: two publishers of joint {joint.name} on {topics}: it goes {np.median(steps):.3g} "
                f"{joint.unit} to and fro between rows, {len(steps)} times of {len(given)}; let one of them "
                "say where it is, and record anew"
            )


def _require_radians(site: Site, path: Path, joints: Sequence[Joint], record: JointRecord) -> None:
    for joint in joints:
        given, entry = record.positions[joint.name], site.entry.joints.get(joint.name)
        beyond = float(((given < joint.lower - 0.1) | (given > joint.upper + 0.1)).mean())
        turned = np.radians(given)
        fits = bool(((turned >= joint.lower - 0.1) & (turned <= joint.upper + 0.1)).all())
        why = ""
        turns = np.round((given - (joint.lower + joint.upper) / 2) / (2 * np.pi))
        turned_back = given - turns * 2 * np.pi
        is_back = bool(((turned_back >= joint.lower) & (turned_back <= joint.upper)).all())
        if beyond > 0.2 and is_back and np.ptp(turns) == 0 and abs(turns[0]) <= MOST_TURNS:
            raise JointsError(
                f"{path}: joint {joint.name} up to {np.abs(given).max():g}, its limits are {joint.lower:g} to "
                f"{joint.upper:g} rad: that is {abs(turns[0]):g} whole turns off; write it within its limits, or give "
                "the joint those that it has"
            )
        if beyond > 0.2 and fits:
            why = f"up to {np.abs(given).max():g}, its limits are {joint.lower:g} to {joint.upper:g} rad"
        elif entry is not None and len(given) > 1:
            fastest = _fastest(record.stamps_ns, steps_of(joint, given))
            limit = entry.speed_of(joint)
            if fastest > TOO_FAST * limit and np.radians(fastest) < SLOW_ENOUGH * limit:
                why = f"moves at {fastest:.3g} rad/s, its full speed is {limit:.3g} rad/s"
        if why:
            raise JointsError(
                f"{path}: joint {joint.name} {why}: these look like degrees; say angle_unit: deg in recording"
            )


def _fastest(stamps_ns: NDArray[np.int64], steps: NDArray[np.float64]) -> float:
    """The speed that nineteen of twenty moving rows stay below [units of the positions a second]."""
    speeds = np.abs(steps) / (np.diff(stamps_ns) / 1e9)
    moving = speeds[speeds > 0]
    return float(np.percentile(moving, 95)) if len(moving) else 0.0


def require_meeting(path: Path, record: JointRecord, meeting: Meeting) -> None:
    """Refuses a record whose times cannot be those of the images.

    Args:
        path: of the record, to be named.
        record: of the machine.
        meeting: of the images.

    Raises:
        JointsError: rows closer than any machine tells, or from another time than all images.
    """
    rows, images = _span(record), _images(meeting)
    step = usual_step_ns(record.stamps_ns)
    known = float(_known(record, meeting.lead.stamps_ns).mean())
    for unit, ns in NS.items():
        if ns > 1 and known < SCARCE and _fits(rows, images, ns):
            raise JointsError(
                f"{path}: as nanoseconds, joints are known at {100 * known:.0f} % of the images, as {WORDS[unit]} from "
                f"beginning to end: name that column stamp_{unit}"
            )
    if step is not None and step < 1e9 / FASTEST_ROWS_HZ:
        fits = [unit for unit, ns in NS.items() if ns > 1 and 1 / 60 < 1e9 / (step * ns) <= FASTEST_ROWS_HZ]
        likely = (
            f"they look like {WORDS[fits[0]]}: name that column stamp_{fits[0]}"
            if fits
            else "are they times?"
        )
        raise JointsError(f"{path}: as nanoseconds, {1e9 / step:,.0f} rows a second; {likely}")
    require_span(
        path,
        record,
        meeting,
        "The column of times may be named stamp_ns, stamp_us, stamp_ms or stamp_s",
    )


def require_span(path: Path, record: JointRecord, meeting: Meeting, advice: str) -> None:
    """Refuses a record that knows nothing of any image, from before the first to after the last.

    Args:
        path: of the record, to be named.
        record: of the machine.
        meeting: of the images.
        advice: what to do, at the end of the message.

    Raises:
        JointsError: with both spans of time, and the likely cause.
    """
    rows, images = _span(record), _images(meeting)
    if float(_known(record, meeting.lead.stamps_ns).mean()) == 0 and not rows.covers(images):
        raise JointsError(
            f"{path}: joints from {span_text(rows.first_ns, rows.last_ns)}, images from "
            f"{span_text(images.first_ns, images.last_ns)}: they never meet; {cause_text(rows, images)}. {advice}"
        )


def _fits(rows: Span, images: Span, ns: int) -> bool:
    """Whether rows in another unit begin and end where the images do, give or take a fifth of their length."""
    slack = 0.2 * (images.last_ns - images.first_ns)
    begins, ends = abs(rows.first_ns * ns - images.first_ns), abs(rows.last_ns * ns - images.last_ns)
    return begins <= slack and ends <= slack


def joint_findings(
    path: Path, record: JointRecord, meeting: Meeting, is_played: bool = False
) -> Iterator[Finding]:
    """Moments of which a record does not know where the machine was.

    Args:
        path: of the record.
        record: of the machine.
        meeting: of the images.
        is_played: whether `monitor` goes on where nobody knows where the machine is, as with a bag.
    """
    taken = meeting.taken()
    known = np.ones(len(meeting.lead), dtype=np.bool_)
    for row, index in zip(meeting.series, taken, strict=True):
        there = index >= 0
        known[there] &= _known(record, row.stamps_ns[index[there]])
    without = int((~known).sum())
    if not without:
        return
    rows, images = _span(record), _images(meeting)
    parts = []
    if rows.first_ns > images.first_ns + END_SLACK_NS:
        parts.append(f"begin {length_text(rows.first_ns - images.first_ns)} after the images")
    if rows.last_ns < images.last_ns - END_SLACK_NS:
        parts.append(f"end {length_text(images.last_ns - rows.last_ns)} before them")
    if not parts:
        parts.append("have gaps longer than max_joint_gap_ms")
    first = int(np.argmin(known))
    there = "in which every motion is stop" if is_played else "where monitor ends"
    text = (
        f"{path.name}: joints {' and '.join(parts)}: {without} of {len(known)} moments have none, the first is moment "
        f"{first}, {there}"
    )
    yield Finding("joints", (), text, False)


def _known(record: JointRecord, stamps_ns: NDArray[np.int64]) -> NDArray[np.bool_]:
    """At which times `JointRecord.at` has an answer."""
    rows = record.stamps_ns
    inside = (stamps_ns >= rows[0] - END_SLACK_NS) & (stamps_ns <= rows[-1] + END_SLACK_NS)
    if record.max_gap_ns is None or len(rows) < 2:
        return inside
    clamped = np.clip(stamps_ns, rows[0], rows[-1])
    after = np.searchsorted(rows, clamped)
    before = np.maximum(after - 1, 0)
    return inside & ((rows[after] == clamped) | (rows[after] - rows[before] <= record.max_gap_ns))


def _span(record: JointRecord) -> Span:
    return Span(int(record.stamps_ns[0]), int(record.stamps_ns[-1]))


def _images(meeting: Meeting) -> Span:
    heard = [row for row in meeting.series if len(row)]
    return Span(min(row.first_ns for row in heard), max(row.last_ns for row in heard))
