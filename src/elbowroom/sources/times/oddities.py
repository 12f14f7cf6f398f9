"""What is odd about when the images of a recording were taken, though each moment can be judged."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from elbowroom.finding import Finding
from elbowroom.sources.times.cause import Span
from elbowroom.sources.times.company import never_text
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.series import Series, length_text, span_text, time_text
from elbowroom.sources.times.stamp import NS, WORDS, hz

LOST_SHARE, EVENLY_LEAST = 0.05, 4
"""A camera that lacks more of its images than this is named, or so many at even distances."""
SKEW_SHARE = 0.02
"""And one that is left out of more moments than this because its nearest image is of another."""
APART_STEPS, DRIFT_STEPS = 5, 2
"""Beginnings and ends that lie farther apart than so many steps are looked at: both alike, or the ends alone."""
PRESENT_SHARE = 0.9
"""A camera that is part of fewer moments than this is named."""
FAST, FASTEST = 1e-3, 0.1
"""A clock that runs fast or slow by between these shares."""
BURST, BURST_SHARE = 0.2, 0.05
"""Steps shorter than this share of the usual one come in bursts, if so many do."""
RARE_HZ = 1 / 10
"""Slower than this, another unit is likelier, if it gives what cameras do."""


def findings_of(meeting: Meeting) -> tuple[Finding, ...]:
    """All that is odd about when a recording's images were taken; none of it keeps moments from being judged."""
    never = [*_who_never_meets(meeting)]
    found = [*never, *_unit(meeting), *_gaps(meeting)]
    for row in meeting.series:
        if len(row) and (row.camera,) not in [finding.about for finding in never]:
            of_it = [*_too_many_steps(meeting, row), *_lost(meeting, row)]
            if row is not meeting.lead:
                of_it += _offset(meeting, row)
            found += [*(of_it or _absent(meeting, row)), *_bursts(row)]
    return tuple(found)


def _who_never_meets(meeting: Meeting) -> Iterator[Finding]:
    taken = meeting.taken()
    for row, index in zip(meeting.series, taken, strict=True):
        if len(row) and (index < 0).all():
            text = f"{never_text(meeting, row)}. As it is, {row.camera} disputes all that it looks at"
            yield Finding("clock", (row.camera,), text, False)


def _too_many_steps(meeting: Meeting, row: Series) -> Iterator[Finding]:
    count = meeting.too_many_steps(row)
    if count > max(1, SKEW_SHARE * len(meeting.lead)):
        step = row.step_ns or meeting.lead.step_ns or 0.0
        text = (
            f"camera {row.camera} is left out of {count} of {len(meeting.lead)} moments: its nearest image is more "
            f"than three of its steps of {length_text(step)} away, though within max_skew_ms, "
            f"{length_text(meeting.max_skew_ns)}"
        )
        yield Finding("skew", (row.camera,), text, False)


def _unit(meeting: Meeting) -> Iterator[Finding]:
    """Stamps that are possible, but likelier in another unit."""
    step, lead = meeting.lead.step_ns, meeting.lead
    skew = int(meeting.skews_ns().max())
    if step is None and not meeting.declared and skew > 0 and lead.last_ns < 1e9:
        text = (
            f"one image a camera, {length_text(skew)} apart as nanoseconds: nothing shows the unit of their stamps; "
            "say stamp_unit in recording"
        )
        yield Finding("unit", (), text, False)
    if meeting.unsure and step is not None:
        micro = span_text(lead.first_ns * NS["us"], lead.last_ns * NS["us"])
        text = (
            f"are stamps nanoseconds? As they are, images are from {lead.span}; as microseconds, from {micro}: say "
            "stamp_unit: ns or us in recording. Until then an image counts for its nearest moment alone"
        )
        yield Finding("unit", (), text, False)
    if step is not None and 1e9 / step < RARE_HZ and len(lead) > 2:
        for unit, factor in NS.items():
            if factor > 1 and 1 <= 1e9 * factor / step <= 120:
                text = (
                    f"{hz(step)}; were these stamps a {factor:,}th of that, it would be {hz(step / factor)}: is "
                    f"stamp_unit right, {WORDS[unit]} for nanoseconds?"
                )
                yield Finding("unit", (), text, False)


def _gaps(meeting: Meeting) -> Iterator[Finding]:
    lead = meeting.lead
    long = np.flatnonzero(lead.steps_ns > meeting.gap_ns)
    if not len(long):
        return
    worst = int(long[np.argmax(lead.steps_ns[long])])
    before, after = int(lead.stamps_ns[worst]), int(lead.stamps_ns[worst + 1])
    more = f", the longest of {len(long)} such gaps" if len(long) > 1 else ""
    set_ = not Span(before, before).are_dates and Span(after, after).are_dates
    why = ": was the clock set in between?" if set_ else ""
    text = (
        f"no image for {length_text(after - before)} after moment {worst} ({time_text(before)} to {time_text(after)})"
        f"{more}{why}; monitor skips it"
    )
    yield Finding("gap", (), text, False)


def _lost(meeting: Meeting, row: Series) -> Iterator[Finding]:
    """Images that a camera lacks among its own, where the others have theirs."""
    step = row.step_ns
    if step is None or step <= 0 or len(row) < 10:
        return
    steps = row.steps_ns
    missing = np.where(steps <= meeting.gap_ns, np.rint(steps / step) - 1, 0).clip(0)
    lost, whole = int(missing.sum()), int(missing.sum()) + len(row)
    often = _how_often(missing)
    if lost > max(EVENLY_LEAST, LOST_SHARE * whole) or (lost >= EVENLY_LEAST and "evenly" in often):
        text = f"camera {row.camera} lacks {lost} of {whole} images ({often}): there it counts as lost"
        yield Finding("lost", (row.camera,), text, False)


def _absent(meeting: Meeting, row: Series) -> Iterator[Finding]:
    """A camera that has images, but for many moments none."""
    there = int((meeting.taken()[list(meeting.series).index(row)] >= 0).sum())
    lead = meeting.lead
    if not 0 < there < PRESENT_SHARE * len(lead):
        return
    step = row.step_ns or 0.0
    parts = []
    if row.first_ns - lead.first_ns > max(meeting.max_skew_ns, step):
        parts.append(f"begin {length_text(row.first_ns - lead.first_ns)} later")
    if lead.last_ns - row.last_ns > max(meeting.max_skew_ns, step):
        parts.append(f"end {length_text(lead.last_ns - row.last_ns)} earlier")
    why = (
        f"its images {' and '.join(parts)} than those of camera {lead.camera}"
        if parts
        else "it gives fewer images"
    )
    text = (
        f"camera {row.camera} is part of {there} of {len(lead)} moments, elsewhere it counts as lost: {why}"
    )
    yield Finding("lost", (row.camera,), text, False)


def _how_often(missing: NDArray[np.float64]) -> str:
    at = np.flatnonzero(missing > 0)
    every = np.diff(at)
    if len(at) > 2 and every.min() == every.max() and (missing[at] == 1).all():
        return f"one in {int(every[0]) + 1}, evenly"
    longest = int(missing.max())
    return f"at {len(at)} places, up to {longest} in a row" if longest > 1 else f"at {len(at)} places"


def _bursts(row: Series) -> Iterator[Finding]:
    step = row.step_ns
    if step is None or len(row) < 20:
        return
    share = float((row.steps_ns < BURST * step).mean())
    if share > BURST_SHARE:
        text = (
            f"camera {row.camera}: {100 * share:.0f} % of its images follow the one before within a fifth of the usual "
            f"{length_text(step)}: stamps look like times of arrival; they must be times of exposure"
        )
        yield Finding("burst", (row.camera,), text, False)


def _offset(meeting: Meeting, row: Series) -> Iterator[Finding]:
    """A clock that is constantly off, or runs fast or slow, beside the leading camera's."""
    lead = meeting.lead
    step, usual = row.step_ns, lead.step_ns
    if step is None or usual is None or len(row) < 10 or abs(len(row) - len(lead)) > 0.02 * len(lead) + 1:
        return
    begins, ends = row.first_ns - lead.first_ns, row.last_ns - lead.last_ns
    far = max(APART_STEPS * max(step, usual), 2 * meeting.max_skew_ns)
    length, whole = row.last_ns - row.first_ns, lead.last_ns - lead.first_ns
    ratio = length / whole - 1
    if abs(begins) > far and abs(ends - begins) < 0.1 * abs(begins) + 2 * usual:
        way = "later" if begins > 0 else "earlier"
        text = (
            f"camera {row.camera} begins and ends {length_text(begins)} {way} than camera {lead.camera}, with as many "
            "images: is its clock off by that?"
        )
        yield Finding("clock", (row.camera,), text, False)
    elif (
        FAST < abs(ratio) < FASTEST
        and abs(ends - begins) > DRIFT_STEPS * usual
        and abs(step / usual - 1 - ratio) < 0.3 * abs(ratio)
    ):
        way = "fast" if ratio > 0 else "slow"
        text = (
            f"the clock of camera {row.camera} seems to run {100 * abs(ratio):.2g} % {way}: as many images as camera "
            f"{lead.camera} in {length_text(length)} instead of {length_text(whole)}"
        )
        yield Finding("clock", (row.camera,), text, False)
