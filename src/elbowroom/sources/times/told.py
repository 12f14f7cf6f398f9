"""Rate, skew and span of a recording, as a row and in words."""

from typing import Any

from elbowroom.sources.times.meeting import Meeting
from elbowroom.sources.times.series import Series, length_text
from elbowroom.sources.times.stamp import hz

SHOWN = 6
"""Of cameras with one span between them so many are named."""


def times_row(meeting: Meeting) -> dict[str, Any]:
    """Rate and skew of all, and of each camera how many images from when to when."""
    step, skew = meeting.lead.step_ns, int(meeting.skews_ns().max())
    rate = "one image a camera" if step is None else hz(step)
    return {
        "rate_hz": None if step is None else 1e9 / step,
        "skew_ms": skew / 1e6,
        "text": f"{rate}, skew up to {length_text(skew)}",
        "cameras": [_camera_row(row) for row in meeting.series if len(row)],
        "spans": _spans(meeting),
    }


def _camera_row(row: Series) -> dict[str, Any]:
    return {
        "camera": row.camera,
        "images": len(row),
        "first_ns": row.first_ns,
        "last_ns": row.last_ns,
        "rate_hz": None if row.step_ns is None else 1e9 / row.step_ns,
    }


def _spans(meeting: Meeting) -> list[str]:
    """A line for all cameras that began and ended together, give or take two steps, with as many images."""
    alike: list[list[Series]] = []
    for row in meeting.series:
        if not len(row):
            continue
        slack = 2 * (row.step_ns or 1e9 * 0.05)
        for group in alike:
            first = group[0]
            if len(first) == len(row) and max(
                abs(first.first_ns - row.first_ns), abs(first.last_ns - row.last_ns)
            ) <= min(slack, 1e9):
                group.append(row)
                break
        else:
            alike.append([row])
    return [_line(group) for group in alike]


def _line(group: list[Series]) -> str:
    first = group[0]
    names = ", ".join(row.camera for row in group[:SHOWN])
    more = f" and {len(group) - SHOWN} more" if len(group) > SHOWN else ""
    rate = "" if first.step_ns is None else f", {hz(first.step_ns)}"
    images = f"{len(first)} image{'s' * (len(first) > 1)}"
    return f"{names}{more}: {images}, {first.span}{rate}"
