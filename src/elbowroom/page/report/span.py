"""Which passes a report is about."""

import time
from dataclasses import dataclass

from elbowroom.errors import InputError
from elbowroom.monitor.blackbox.recording import Recording
from elbowroom.page.replay.stops import Stop

BEFORE = 0.75
"""Share of its time that lies before the moment that it is about."""


@dataclass(frozen=True, slots=True)
class Span:
    """Passes of a recording, and the one that it is about.

    Args:
        first, last: numbers in the file.
        about: number in the file.
    """

    first: int
    last: int
    about: int


def at_stop(stops: list[Stop], number: int | None) -> int:
    """The pass of a stop.

    Args:
        stops: of the recording.
        number: from 1; None: the first one, or the beginning where there is none.

    Raises:
        InputError: there is no such stop.
    """
    if number is None:
        return stops[0].index if stops else 0
    if not 1 <= number <= len(stops):
        raise InputError(f"stop: {number} is not there; the recording has {len(stops)} stops, from 1")
    return stops[number - 1].index


def at_time(recording: Recording, text: str) -> int:
    """The pass that was newest at a time of day.

    Args:
        recording: the file.
        text: "12:03:07", or with tenths "12:03:07.4", as this computer's calendar has it.

    Raises:
        InputError: no time, or one that the recording does not hold.
    """
    wanted = _seconds(text)
    found = None
    for number in range(len(recording)):
        wall_ns = recording.said_at(number)["wall_ns"]
        moment = time.localtime(wall_ns / 1e9)
        seconds = 3600 * moment.tm_hour + 60 * moment.tm_min + moment.tm_sec + wall_ns % 10**9 / 1e9
        if seconds > wanted + 1e-9:
            break
        found = number
    else:
        found = found if found is not None and wanted - seconds < 1.0 else None
    if found is None:
        raise InputError(f"at: {text} is not within the recording")
    return found


def span_of(recording: Recording, about: int, seconds: float) -> Span:
    """The passes about one, most of them before it.

    Args:
        recording: the file.
        about: number of the pass in the file.
        seconds: how long [s].
    """

    def wall_ns(number: int) -> int:
        return int(recording.said_at(number)["wall_ns"])

    middle = wall_ns(about)
    begin_ns, end_ns = middle - int(1e9 * BEFORE * seconds), middle + int(1e9 * (1 - BEFORE) * seconds)
    first = last = about
    while first > 0 and wall_ns(first - 1) >= begin_ns:
        first -= 1
    while last + 1 < len(recording) and wall_ns(last + 1) <= end_ns:
        last += 1
    return Span(first, last, about)


def _seconds(text: str) -> float:
    """Since midnight [s]."""
    parts = text.split(":")
    try:
        hours, minutes, seconds = int(parts[0]), int(parts[1]), float(parts[2]) if len(parts) > 2 else 0.0
    except (ValueError, IndexError):
        hours = minutes = -1
        seconds = 0.0
    if len(parts) > 3 or not (0 <= hours < 24 and 0 <= minutes < 60 and 0 <= seconds < 61):
        raise InputError(f"at: {text!r} is no time of day; write 12:03:07")
    return 3600 * hours + 60 * minutes + seconds
