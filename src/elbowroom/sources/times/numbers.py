"""Numbers in names of images that have no times: their order, and whether those of one moment agree."""

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from elbowroom.errors import SiteError
from elbowroom.finding import Finding
from elbowroom.sources.times.date import date_in

SHOWN = 4


def natural(path: Path) -> tuple[tuple[int, int, str], ...]:
    """A key that sorts names as people do: numbers as numbers, 9 before 10; 09 beside 9."""
    parts = re.split(r"([0-9]+)", path.as_posix())
    key = tuple((0, int(part), "") if n % 2 else (1, 0, part) for n, part in enumerate(parts))
    return (*key, (2, 0, path.as_posix()))


def counters(paths: Sequence[Path]) -> NDArray[np.int64] | None:
    """What counts the images in their names: the numbers that change from one to the next, those of a date as its time.

    Args:
        paths: of one camera's images.

    Returns:
        shape (n,); None: there is none, or several that are no date.
    """
    found = [re.findall(r"[0-9]+", path.as_posix()) for path in paths]
    column = _counting_column(found)
    if column is not None:
        return np.array([int(numbers[column]) for numbers in found], dtype=np.int64)
    if len(paths) < 2:
        return None
    times = [date_in(path.name) for path in paths]
    if any(time is None for time in times) or len(set(times)) == 1:
        return None
    return np.array(times, dtype=np.int64)


def _counting_column(found: Sequence[Sequence[str]]) -> int | None:
    """Of the numbers in each name the only one that changes; None: there is none, or there are several."""
    if len(found) < 2 or len({len(numbers) for numbers in found}) != 1:
        return None
    changing = [n for n in range(len(found[0])) if len({int(numbers[n]) for numbers in found}) > 1]
    # what 64 bits do not hold counts nothing
    return changing[0] if len(changing) == 1 and max(int(row[changing[0]]) for row in found) < 2**62 else None


def padding_findings(rows: Mapping[str, Sequence[Path]]) -> tuple[Finding, ...]:
    """What is said where cameras write the number of one moment in different ways: 9 and 09.

    Args:
        rows: by camera, in order; they agree.
    """
    texts = {}
    for name, row in rows.items():
        found = [re.findall(r"[0-9]+", path.as_posix()) for path in row]
        column = _counting_column(found)
        if column is not None:
            texts[name] = [numbers[column] for numbers in found]
    for name, row in texts.items():
        for lead, others in texts.items():
            for number, other in zip(row, others, strict=False):
                if number != other and int(number) == int(other):
                    text = (
                        f"camera {name} writes {number} where camera {lead} writes {other}: images are in order "
                        "of their numbers"
                    )
                    return (Finding("names", (name, lead), text, False),)
    return ()


def require_agreement(site: Path, rows: Mapping[str, Sequence[Path]], listed: Collection[str] = ()) -> None:
    """Refuses images that are not as many of each camera, or whose n-th ones are not of one number, where names count.

    A number agrees if no other image of that camera would be nearer: times of cameras that ran freely do.

    Args:
        site: the site's file, to be named.
        rows: by camera, in order.
        listed: cameras whose images the site names one by one: their numbers say nothing.

    Raises:
        SiteError: a number that is there twice, missing, or another one at the same moment; names camera and image.
    """
    counted = {name: counters(row) for name, row in rows.items() if name not in listed}
    numbers = {name: found for name, found in counted.items() if found is not None}
    for name, found in numbers.items():
        doubled = np.flatnonzero(np.diff(found) == 0)
        if len(doubled):
            first, second = (rows[name][int(doubled[0]) + n].name for n in (0, 1))
            raise SiteError(
                f"{site}: recording: {first} and {second} of camera {name} have one number; which is it?"
            )
    if len({len(row) for row in rows.values()}) != 1:
        raise SiteError(f"{site}: recording: {_counts_differ(rows, numbers)}")
    if len(numbers) < 2:
        return
    lead = next(iter(numbers))
    for name, found in numbers.items():
        at = _first_elsewhere(numbers[lead], found)
        if at is not None:
            raise SiteError(f"{site}: recording: {_disagree(rows, numbers, lead, name, at)}")


def _counts_differ(rows: Mapping[str, Sequence[Path]], numbers: Mapping[str, NDArray[np.int64]]) -> str:
    found = ", ".join(f"{name} {len(row)}" for name, row in rows.items())
    text = f"frames per camera are {found}; without times they must be as many"
    every = set[int]().union(*(set(row.tolist()) for row in numbers.values()))
    lacking = {name: sorted(every - set(row.tolist())) for name, row in numbers.items()}
    if len(every) > 2 * max((len(row) for row in numbers.values()), default=0):
        return text  # their numbers have nothing in common
    said = [f"{name} lacks {_shown(missing)}" for name, missing in lacking.items() if missing]
    return f"{text}: {'; '.join(said)}. Remove what the others lack, or give times" if said else text


def _first_elsewhere(lead: NDArray[np.int64], other: NDArray[np.int64]) -> int | None:
    """The first moment whose image has a neighbour that is nearer in number; None: none has."""
    away = np.abs(other - lead)
    before = np.abs(other[:-1] - lead[1:]) < away[1:]
    after = np.abs(other[1:] - lead[:-1]) < away[:-1]
    wrong = np.zeros(len(lead), dtype=np.bool_)
    wrong[1:] |= before
    wrong[:-1] |= after
    # counts must be the same, only times may differ a little
    if (np.diff(lead) == 1).mean() > 0.5 or (np.diff(other) == 1).mean() > 0.5:
        wrong |= away > 0
    return int(np.argmax(wrong)) if wrong.any() else None


def _disagree(
    rows: Mapping[str, Sequence[Path]],
    numbers: Mapping[str, NDArray[np.int64]],
    lead: str,
    name: str,
    at: int,
) -> str:
    """How names of one moment differ, and the likely cause."""
    here, there = numbers[lead], numbers[name]
    first, second = rows[lead][at].name, rows[name][at].name
    text = f"images of moment {at} are {first} of camera {lead} and {second} of camera {name}"
    apart = np.unique(there - here)
    lacks = sorted(set(here.tolist()) - set(there.tolist()))
    if int(min(here.min(), there.min())) >= 10**9:
        why = "these look like times: say layout: folder"
    elif len(apart) == 1:
        why = f"one counts from {here[0]}, the other from {there[0]}, or is that much late"
    else:
        why = f"{name} lacks {_shown(lacks)}" if lacks else "they count otherwise"
    return f"{text}: {why}. Rename or remove images, or list those that belong together in recording.files"


def _shown(numbers: Sequence[int]) -> str:
    more = f" and {len(numbers) - SHOWN} more" if len(numbers) > SHOWN else ""
    return f"{', '.join(map(str, numbers[:SHOWN]))}{more}"
