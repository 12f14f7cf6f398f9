"""Whether the cameras of a recording keep each other company in time."""

from pathlib import Path

from elbowroom.errors import SiteError
from elbowroom.sources.times.cause import Span, cause_text
from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.series import Series, length_text, span_text
from elbowroom.sources.times.stamp import NS, WORDS


def require_company(site: Path, meeting: Meeting) -> None:
    """Refuses a recording of several cameras in which no two ever meet: nothing could be said of any moment.

    Raises:
        SiteError: with both spans of time, and the likely cause.
    """
    heard = [row for row in meeting.series if len(row)]
    if len(heard) < 2 or ((meeting.taken() >= 0).sum(axis=0) > 1).any():
        return
    odd = next(row for row in heard if row is not meeting.lead)
    raise SiteError(f"{site}: recording: no moment has images of two cameras: {never_text(meeting, odd)}")


def require_dates(site: Path, meeting: Meeting) -> None:
    """Refuses single images that are dates in a coarser unit, where that would put them too far apart for one moment.

    Args:
        site: the site's file, to be named.
        meeting: of its recording, as nanoseconds.

    Raises:
        SiteError: names the unit.
    """
    if meeting.declared or meeting.lead.step_ns is not None:
        return
    heard = [row for row in meeting.series if len(row)]
    first, last = min(row.first_ns for row in heard), max(row.last_ns for row in heard)
    skew = int(meeting.skews_ns().max())
    for unit, factor in NS.items():
        if (
            factor > 1
            and skew * factor > meeting.max_skew_ns
            and Span(first * factor, last * factor).are_dates
        ):
            raise SiteError(
                f"{site}: recording: stamps look like {WORDS[unit]} ({span_text(first * factor, last * factor)}), and "
                f"then images of one moment are {length_text(skew * factor)} apart; say stamp_unit: {unit} in "
                "recording, or stamp_unit: ns if they are right"
            )


def never_text(meeting: Meeting, odd: Series) -> str:
    """That a camera's images never meet those of the leading one, with both spans of time and the likely cause.

    Args:
        meeting: of the recording.
        odd: of the camera.
    """
    lead = meeting.lead
    skew = length_text(meeting.limit_ns(odd))
    nearest = int(meeting.nearest_ns(odd).min())
    said = (
        f"images of camera {odd.camera} ({odd.span}) are never within {skew} of those of camera {lead.camera} "
        f"({lead.span}); "
    )
    if _is_close(meeting, odd):
        return f"{said}the nearest two are {length_text(nearest)} apart: is max_skew_ms too small?"
    these, others = Span(odd.first_ns, odd.last_ns), Span(lead.first_ns, lead.last_ns)
    return f"{said}{cause_text(these, others)}"


def _is_close(meeting: Meeting, odd: Series) -> bool:
    """Whether a camera's nearest image is no farther off than images usually are apart."""
    steps = [step for step in (odd.step_ns, meeting.lead.step_ns) if step is not None]
    return bool(steps) and int(meeting.nearest_ns(odd).min()) <= max(steps)
