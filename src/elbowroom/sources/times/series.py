"""The times of one camera's images, and how a time is written."""

from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

DATES_FROM_NS = 946_684_800 * 1_000_000_000
"""From the year 2000 on [ns since 1970] a time is shown as a date."""
DATES_TO_NS = 4_102_444_800 * 1_000_000_000
"""And up to the year 2100 [ns since 1970]."""


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """When a camera's images were exposed.

    Args:
        camera: its name.
        stamps_ns: strictly rising [ns], shape (n,); it may have none.
    """

    camera: str
    stamps_ns: NDArray[np.int64]

    def __post_init__(self) -> None:
        stamps = np.array(self.stamps_ns, dtype=np.int64)
        stamps.setflags(write=False)
        object.__setattr__(self, "stamps_ns", stamps)

    def __len__(self) -> int:
        return len(self.stamps_ns)

    @property
    def first_ns(self) -> int:
        """Of the first image [ns]."""
        return int(self.stamps_ns[0])

    @property
    def last_ns(self) -> int:
        """Of the last image [ns]."""
        return int(self.stamps_ns[-1])

    @property
    def steps_ns(self) -> NDArray[np.int64]:
        """Between each image and the next [ns], shape (n - 1,)."""
        return np.diff(self.stamps_ns)

    @property
    def step_ns(self) -> float | None:
        """The usual step, as `usual_step_ns`."""
        return usual_step_ns(self.stamps_ns)

    @property
    def span(self) -> str:
        """From when to when, in words."""
        return span_text(self.first_ns, self.last_ns)


def usual_step_ns(stamps_ns: NDArray[np.int64]) -> float | None:
    """The median step, of two the shorter one [ns]; None: there are fewer than two stamps.

    Args:
        stamps_ns: rising [ns], shape (n,).
    """
    steps = np.sort(np.diff(stamps_ns))
    return float(steps[(len(steps) - 1) // 2]) if len(steps) else None


def span_text(first_ns: int, last_ns: int) -> str:
    """From when to when: dates where they are some, seconds otherwise.

    Args:
        first_ns, last_ns: [ns].
    """
    first, last = time_text(first_ns), time_text(last_ns)
    if first_ns == last_ns:
        return first
    if not (first.endswith("UTC") and last.endswith("UTC")):
        return f"{first} to {last}"
    day = len("2000-01-01 ") if first[:11] == last[:11] else 0
    return f"{first.removesuffix(' UTC')} to {last[day:]}"


def are_dates(first_ns: int, last_ns: int) -> bool:
    """Whether both lie between the years 2000 and 2100.

    Args:
        first_ns, last_ns: [ns].
    """
    return first_ns >= DATES_FROM_NS and last_ns < DATES_TO_NS


def time_text(stamp_ns: int) -> str:
    """A time: "2023-11-14 22:13:20.500 UTC" from 2000 to 2100, otherwise seconds of its clock: "5.500 s"."""
    if not are_dates(stamp_ns, stamp_ns):
        return f"{stamp_ns / 1e9:.3f} s"
    whole, rest = divmod(stamp_ns, 1_000_000_000)
    date = datetime.fromtimestamp(whole, UTC).strftime("%Y-%m-%d %H:%M:%S")
    return f"{date}.{rest // 1_000_000:03d} UTC"


def length_text(length_ns: float) -> str:
    """A length of time as people say it: "8 ms", "12.5 s", "59 min 59 s", "54 years".

    Args:
        length_ns: [ns], its sign is dropped.
    """
    seconds = abs(length_ns) / 1e9
    if seconds < 0.0995:
        return f"{seconds * 1e3:.3g} ms"
    if seconds < 120:
        return f"{seconds:.4g} s"
    if seconds < 7200:
        minutes, rest = divmod(round(seconds), 60)
        return f"{minutes} min {rest} s"
    if seconds < 172_800:
        return f"{seconds / 3600:.1f} h"
    days = seconds / 86_400
    return f"{days:.0f} days" if days < 730 else f"{days / 365.25:.0f} years"
