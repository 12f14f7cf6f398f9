"""Times of exposure as file names say them, and in which unit they can be meant."""

import re
from collections.abc import Mapping, Sequence
from decimal import Decimal
from pathlib import Path

import numpy as np

from elbowroom.errors import FrameError, SiteError
from elbowroom.site.recording_entry import StampUnit
from elbowroom.sources.times.date import date_in
from elbowroom.sources.times.series import are_dates, usual_step_ns

NS: Mapping[StampUnit, int] = {"ns": 1, "us": 1_000, "ms": 1_000_000, "s": 1_000_000_000}
"""Nanoseconds of each unit."""
WORDS: Mapping[StampUnit, str] = {
    "ns": "nanoseconds",
    "us": "microseconds",
    "ms": "milliseconds",
    "s": "seconds",
}
FASTEST_HZ = 300
"""Depth cameras give no more images a second than this."""
FASTEST_BY_WORD_HZ = 1000
"""Nor than this where the site says by `stamp_unit` that its unit is meant."""
SLOWEST_HZ = 1 / 3600
"""What is suggested as the unit gives an image an hour at least."""
UNEVEN = 1.5
"""Steps of a camera that loses nothing are alike to this factor."""
TICK_NS = 100
"""What Windows counts time in [ns]."""
COUNTED = 1_000_000
"""Numbers below this, in equal steps, are more likely a count than times."""
_SECONDS = re.compile(r"(?<![0-9])([0-9]{10})[_\-,: ]([0-9]{1,9})(?![0-9])", re.ASCII)
"""Seconds since 1970 and nanoseconds, parted by something else than a dot."""
_STAMP = re.compile(r"[0-9]{1,19}(\.[0-9]{1,12})?", re.ASCII)


def unit_of(paths: Sequence[Path], declared: StampUnit | None) -> StampUnit:
    """The unit of a recording's stamps: as declared, else seconds where a name has a decimal point, else nanoseconds.

    Args:
        paths: of all images.
        declared: by the site; None: it says nothing.
    """
    if declared is not None:
        return declared
    return "s" if any("." in path.stem and _STAMP.fullmatch(path.stem) for path in paths) else "ns"


def stamp_of(path: Path, unit: StampUnit) -> int:
    """When an image was exposed [ns], by its name.

    Raises:
        FrameError: the name is no time, or one that 64 bits of nanoseconds do not hold.
    """
    if not _STAMP.fullmatch(path.stem):
        raise FrameError(
            f"{path}: name must be the time of exposure in whole nanoseconds, <stamp_ns>{path.suffix}{_hint(path)}"
        )
    stamp = int(path.stem) * NS[unit] if "." not in path.stem else int(Decimal(path.stem) * NS[unit])
    if stamp >= 2**63:
        raise FrameError(
            f"{path}: {path.stem} {WORDS[unit]} are {stamp / 1e9 / 31_556_952:,.0f} years, more than 64 bits of "
            "nanoseconds hold; is it another unit than that of the other names, or than recording.stamp_unit?"
        )
    return stamp


def _hint(path: Path) -> str:
    """What to do about a name that holds a number and more."""
    date = date_in(path.stem)
    if date is not None:
        return f"; this date would be {date * 1000}{path.suffix}, if it is of UTC"
    numbers = re.findall(r"[0-9]+", path.stem)
    if not numbers:
        return ""
    seconds = _SECONDS.search(path.stem)
    if seconds is not None:
        whole, rest = seconds.groups()
        return f"; seconds and nanoseconds? rename it to {whole}.{rest:0>9}{path.suffix}"
    if path.stem.startswith("-"):
        return "; there is none before 0: let the clock count from its start"
    longest = max(numbers, key=len)
    if len(longest) >= 10:
        return (
            f"; rename it to {longest}{path.suffix}, and say recording.stamp_unit if that is not nanoseconds"
        )
    return "; if its number is a count, say layout: stampless"


def require_padded(paths: Sequence[Path]) -> None:
    """Refuses names of seconds and nanoseconds whose nanoseconds lack their zeros: 1.66 for 1.000000066.

    Read as a decimal, 66666667 ns are 0.67 s. Such names have decimals of unlike lengths, of which none begins with a
    zero, though many end with other digits; and with their zeros they step evenly.

    Args:
        paths: of one camera's images.

    Raises:
        FrameError: they look so.
    """
    parted = [path.stem.partition(".") for path in paths if _STAMP.fullmatch(path.stem)]
    rests = [rest for _, dot, rest in parted if dot]
    lengths = {len(rest) for rest in rests}
    if len(rests) < len(paths) or len(lengths) < 2 or max(lengths) > 9 or max(lengths) < 7:
        return
    if any(rest.startswith("0") and rest != "0" for rest in rests):
        return
    read, padded = (
        np.sort([int(whole) * 10**9 + int(fill(rest)) for whole, _, rest in parted])
        for fill in (lambda rest: f"{rest:0<9}", lambda rest: f"{rest:0>9}")
    )
    spread, even = (np.diff(times).max() / max(np.diff(times).min(), 1) for times in (read, padded))
    if even < UNEVEN and spread > 1.02 * even:
        short = next(path for path in paths if len(path.stem.partition(".")[2]) < max(lengths))
        whole, _, rest = short.stem.partition(".")
        raise FrameError(
            f"{short}: seconds and nanoseconds without leading zeros? Then it is {whole}.{rest:0>9}{short.suffix}: "
            "rename all of them so, with nine digits behind the dot"
        )


def require_possible(
    site: Path, stamps_ns: Mapping[str, Sequence[int]], unit: StampUnit, declared: bool
) -> None:
    """Refuses stamps whose steps no depth camera makes.

    Args:
        site: the site's file, to be named.
        stamps_ns: by camera, rising [ns].
        unit: as which they were read.
        declared: whether the site says that unit.

    Raises:
        SiteError: they are counts, or times in another unit; names the one that fits.
    """
    fastest = FASTEST_BY_WORD_HZ if declared else FASTEST_HZ
    steps = {name: usual_step_ns(np.array(stamps, dtype=np.int64)) for name, stamps in stamps_ns.items()}
    wrong = {name: step for name, step in steps.items() if step is not None and step < 1e9 / fastest}
    if not wrong:
        return
    step = float(np.median(list(wrong.values())))
    last = max(stamps_ns[name][-1] for name in wrong) / NS[unit]
    others = [name for name, found in steps.items() if found is not None and name not in wrong]
    raise SiteError(
        f"{site}: recording: stamps of {_cameras(list(wrong))} step by {step / NS[unit]:.12g}, which as "
        f"{WORDS[unit]} is {1e9 / step:,.0f} images a second; depth cameras give at most {fastest}. "
        + _likely(step / NS[unit], last, unit, others)
    )


def hz(step: float) -> str:
    """Images a second of a step [ns], in words: "30.0 images a second", "an image every 12.5 s"."""
    return f"{1e9 / step:.1f} images a second" if step <= 2e9 else f"an image every {step / 1e9:.1f} s"


def _likely(step: float, last: float, unit: StampUnit, others: Sequence[str]) -> str:
    """What stamps that step so fast most likely are, and what to do."""
    longer = [other for other in NS if NS[other] > NS[unit]]
    fitting = [other for other in longer if SLOWEST_HZ <= 1e9 / max(step * NS[other], 1e-9) <= FASTEST_HZ]
    dates = [other for other in fitting if are_dates(round(last * NS[other]), round(last * NS[other]))]
    fitting = dates or fitting
    counts = step <= 10 and last < COUNTED
    if others:
        first = f"as {WORDS[fitting[0]]}, {hz(step * NS[fitting[0]])}" if fitting else "another unit"
        return f"Those of {_cameras(others)} are possible, so these are in another unit ({first}): write all in one"
    if counts or not fitting:
        return "If they are counts and no times, say layout: stampless"
    found = fitting[0]
    ticks = step * TICK_NS
    if found == "us" and unit == "ns" and 1e9 / ticks >= 5 > 1e9 / (step * NS[found]):
        return (
            f"They look like steps of 100 ns, as Windows counts, {hz(ticks)}: multiply them by 100 (or, as "
            f"microseconds, {hz(step * NS[found])}: stamp_unit: us)"
        )
    else_ = ", or layout: stampless if they are counts" if last < COUNTED else ""
    if step * NS[unit] >= 1e9 / FASTEST_BY_WORD_HZ:
        else_ += f", or stamp_unit: {unit} if they are right"
    return (
        f"They look like {WORDS[found]}, {hz(step * NS[found])}: say stamp_unit: {found} in recording{else_}"
    )


def _cameras(names: Sequence[str]) -> str:
    shown = ", ".join(names[:4])
    more = f" and {len(names) - 4} more" if len(names) > 4 else ""
    return f"camera{'s' * (len(names) > 1)} {shown}{more}"
